#include "selftest/case.h"

namespace tristim::selftest {

std::vector<Case> film_cases() {
    return {};
}

} // namespace tristim::selftest
