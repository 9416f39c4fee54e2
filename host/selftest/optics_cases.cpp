#include "selftest/case.h"

namespace tristim::selftest {

std::vector<Case> optics_cases() {
    return {};
}

} // namespace tristim::selftest
