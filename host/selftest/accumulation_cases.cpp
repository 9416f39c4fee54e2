#include "selftest/case.h"

namespace tristim::selftest {

std::vector<Case> accumulation_cases() {
    return {};
}

} // namespace tristim::selftest
