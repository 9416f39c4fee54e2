#pragma once

#include "test_names.h"

#include <gtest/gtest.h>

#include <string>

namespace tristim::test {

/// A method and where direct light comes from: the parameter of tests that run for several.
struct MethodCase {
    const char* method;
    bool direct_photons;
};

inline std::string method_case_name(const testing::TestParamInfo<MethodCase>& info) {
    return test_name(info.param.method) + (info.param.direct_photons ? "_photons" : "_sample");
}

} // namespace tristim::test
