#include "selftest/case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

namespace tristim::selftest {

void Measurement::add(double parameter, double error, const std::function<std::string()>& where_it_is) {
    if (std::isnan(error))
        error = std::numeric_limits<double>::infinity();
    if (inputs++ == 0 || error > worst) {
        worst = error;
        where = where_it_is();
    }
    const auto at = std::lower_bound(curve.begin(), curve.end(), parameter,
                                     [](const CurvePoint& point, double value) { return point.parameter < value; });
    if (at != curve.end() && at->parameter == parameter)
        at->error = std::max(at->error, error);
    else
        curve.insert(at, {parameter, error});
}

std::size_t inputs(const Setting& setting, std::size_t count, std::size_t least) {
    return std::max(least, static_cast<std::size_t>(std::lround(setting.effort * static_cast<double>(count))));
}

::cl::Program build(const Setting& setting, const std::string& file, const Macros& macros) {
    return build_program(setting.device, "selftest/" + file, macros, {setting.fast_math, {}});
}

Programs built_once(Programs build_program) {
    auto built = std::make_shared<std::map<std::pair<cl_context, bool>, ::cl::Program>>();
    return [=](const Setting& setting) {
        const auto [at, is_new] = built->try_emplace({setting.device.context(), setting.fast_math});
        if (is_new)
            at->second = build_program(setting);
        return at->second;
    };
}

std::vector<Case> all_cases() {
    std::vector<Case> all;
    for (const auto& group : {film_cases(), optics_cases(), geometry_cases(), photon_cases(), accumulation_cases(),
                              spectrum_cases(), sequence_cases()})
        all.insert(all.end(), group.begin(), group.end());
    return all;
}

} // namespace tristim::selftest
