#include "selftest/case.h"

namespace tristim::selftest {

std::vector<Case> spectrum_cases() {
    return {};
}

} // namespace tristim::selftest
