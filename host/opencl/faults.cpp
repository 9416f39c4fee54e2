#include "opencl/faults.h"

#include "base/error.h"
#include "base/parse_number.h"

#include <cstdlib>
#include <map>

namespace tristim {

FaultPlan::FaultPlan(const std::string& text) {
    static const std::map<std::string, Kind> kinds{
        {"allocate", Kind::Allocate}, {"build", Kind::Build}, {"launch", Kind::Launch}, {"lost", Kind::Lost}};
    const std::size_t first = text.find(':');
    const std::size_t second = text.find(':', first + 1);
    const auto kind = kinds.find(text.substr(0, first));
    const auto check = [&](bool good) {
        if (!good)
            fail("bad TRISTIM_FAULT \"{}\": it is KIND:COUNT[:PLACE], with KIND allocate, build, launch or lost", text);
    };
    const auto number = [&](std::size_t from, std::size_t to) {
        const auto value = parse_number(text.substr(from, to - from));
        check(value && *value >= 0.0 && *value <= 1e9);
        return *value;
    };
    check(kind != kinds.end() && first != std::string::npos);
    kind_ = kind->second;
    left_ = static_cast<long>(number(first + 1, second == std::string::npos ? text.size() : second));
    if (second != std::string::npos)
        place_ = static_cast<int>(number(second + 1, text.size()));
}

void FaultPlan::before(DeviceCall call) {
    const bool lost = kind_ == Kind::Lost && left_ <= 0;
    const DeviceCall counted = kind_ == Kind::Allocate ? DeviceCall::Allocate
                               : kind_ == Kind::Build  ? DeviceCall::Build
                                                       : DeviceCall::Launch;
    if (!lost && (call != counted || --left_ != 0))
        return;
    switch (kind_) {
    case Kind::Allocate:
        throw ::cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, "clCreateBuffer");
    case Kind::Build:
        throw ::cl::Error(CL_BUILD_PROGRAM_FAILURE, "clBuildProgram");
    case Kind::Launch:
        throw ::cl::Error(CL_OUT_OF_RESOURCES, "clEnqueueNDRangeKernel");
    case Kind::Lost:
        throw ::cl::Error(CL_DEVICE_NOT_AVAILABLE, "clEnqueueNDRangeKernel");
    }
}

std::shared_ptr<FaultPlan> fault_plan_from_environment(int place) {
    const char* text = std::getenv("TRISTIM_FAULT");
    if (text == nullptr)
        return nullptr;
    auto plan = std::make_shared<FaultPlan>(text);
    return plan->place() == place ? plan : nullptr;
}

} // namespace tristim
