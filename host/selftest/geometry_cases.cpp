#include "selftest/case.h"

namespace tristim::selftest {

std::vector<Case> geometry_cases() {
    return {};
}

} // namespace tristim::selftest
