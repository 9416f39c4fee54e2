#include "selftest/case.h"

namespace tristim::selftest {

std::vector<Case> sequence_cases() {
    return {};
}

} // namespace tristim::selftest
