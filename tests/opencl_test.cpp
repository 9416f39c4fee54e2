#include "base/error.h"
#include "opencl/program.h"

#include <gtest/gtest.h>

namespace tristim {
namespace {

TEST(OpenCl, ListsADeviceAndRefusesUnknownOnes) {
    const std::vector<DeviceInfo> devices = list_devices();
    ASSERT_FALSE(devices.empty());
    EXPECT_EQ(open_device("0").info.name, devices[0].name);
    EXPECT_EQ(open_device(devices[0].name.substr(0, 4)).info.index, devices[0].index);
    EXPECT_THROW(open_device("no such device"), Error);
    EXPECT_THROW(open_device("4711"), Error);
}

TEST(OpenCl, BuildFailureShowsTheLog) {
    const Device device = open_device("");
    try {
        build_program(device, "trace_rays.cl", {{"BVH_STACK_SIZE", "not_a_number"}}, {});
        FAIL() << "an undeclared macro value must not build";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("trace_rays.cl"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("not_a_number"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace tristim
