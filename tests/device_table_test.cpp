#include "opencl/device_table.h"

#include "base/error.h"
#include "opencl/device.h"
#include "render/renderer.h"
#include "test_scenes.h"

#include <bit>
#include <cstring>
#include <gtest/gtest.h>

namespace tristim {
namespace {

/// A device that can do everything.
DeviceInfo able_device(cl_device_type type = CL_DEVICE_TYPE_CPU, const std::string& name = "Some Device",
                       const std::string& platform = "Some Platform") {
    DeviceInfo device;
    device.type = type;
    device.name = name;
    device.platform = platform;
    device.opencl_c = "OpenCL C 1.2 some compiler";
    device.largest_group = 1024;
    device.available = true;
    device.compiler = true;
    device.full_profile = true;
    device.little_endian = std::endian::native == std::endian::little;
    return device;
}

TEST(DeviceTable, CpusHaveTheValuesMeasuredOnPoCL) {
    const DeviceTuning tuning = device_tuning(able_device());
    EXPECT_EQ(to_string(tuning), "pixel_group=16,item_group=8,paths_per_item=64,sort_groups=2,scan_group=1,bvh_width=8,"
                                 "loop_steps=4294967295");
    EXPECT_EQ(tuning, DeviceTuning{}) << "the default row";
}

TEST(DeviceTable, GpusHaveWholeWarpsAndFewPathsInARow) {
    const DeviceTuning tuning = device_tuning(able_device(CL_DEVICE_TYPE_GPU));
    EXPECT_LT(tuning.paths_per_item, DeviceTuning{}.paths_per_item);
    EXPECT_GT(tuning.scan_group, 1U);
    EXPECT_EQ(tuning.pixel_group % 32, 0U);
    EXPECT_EQ(tuning.item_group % 32, 0U);
}

TEST(DeviceTable, NamesOfDevicesAndPlatformsGoBeforeTypesWhateverTheirCase) {
    const DeviceTuning llvmpipe = device_tuning(able_device(CL_DEVICE_TYPE_CPU, "llvmpipe (LLVM 15.0.6, 256 bits)"));
    EXPECT_LT(llvmpipe.loop_steps, 65535U);
    EXPECT_EQ(device_tuning(able_device(CL_DEVICE_TYPE_GPU, "LLVMpipe")), llvmpipe);
    EXPECT_EQ(device_tuning(able_device(CL_DEVICE_TYPE_CPU, "A", "Mesa llvmpipe")), llvmpipe);
    EXPECT_NE(device_tuning(able_device(CL_DEVICE_TYPE_CPU, "llvm pipe")), llvmpipe);
}

TEST(DeviceTable, UnknownKindsOfDevicesHaveTheDefaultRow) {
    EXPECT_EQ(device_tuning(able_device(CL_DEVICE_TYPE_ACCELERATOR)), DeviceTuning{});
    EXPECT_EQ(device_tuning(able_device(0)), DeviceTuning{});
}

TEST(DeviceTable, SimulatorsOfEveryKindCountAsCpus) {
    EXPECT_EQ(device_tuning(able_device(CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR)),
              device_tuning(able_device()));
}

TEST(DeviceTable, GroupsAreLoweredToWhatTheDeviceAllows) {
    DeviceInfo gpu = able_device(CL_DEVICE_TYPE_GPU);
    gpu.largest_group = 48;
    const DeviceTuning tuning = device_tuning(gpu);
    EXPECT_EQ(tuning.pixel_group, 48U);
    EXPECT_EQ(tuning.item_group, 32U);
    EXPECT_EQ(tuning.scan_group, 48U);
    gpu.largest_group = 1;
    EXPECT_EQ(device_tuning(gpu).pixel_group, 1U);
    EXPECT_EQ(device_tuning(gpu).item_group, 1U);
}

TEST(DeviceTable, TuningIsReadAsItIsWritten) {
    const DeviceTuning changed = parse_tuning("pixel_group=32,bvh_width=4", DeviceTuning{});
    EXPECT_EQ(changed.pixel_group, 32U);
    EXPECT_EQ(changed.bvh_width, 4);
    EXPECT_EQ(changed.item_group, DeviceTuning{}.item_group);
    const DeviceTuning all{
        .pixel_group = 1, .item_group = 2, .paths_per_item = 3, .sort_groups = 4, .bvh_width = 2, .loop_steps = 5000};
    EXPECT_EQ(parse_tuning(to_string(all), DeviceTuning{}), all);
}

TEST(DeviceTable, TuningThatNoDeviceCanTakeIsRefused) {
    const auto message = [](const std::string& changes) -> std::string {
        try {
            parse_tuning(changes, DeviceTuning{});
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_EQ(message("pixels=3"), "--tuning: 'pixels' is none of pixel_group, item_group, paths_per_item, "
                                   "sort_groups, scan_group, bvh_width, loop_steps");
    EXPECT_EQ(message("pixel_group=0"), "--tuning: pixel_group must be a number from 1 to 4096, not '0'");
    EXPECT_EQ(message("pixel_group=5000"), "--tuning: pixel_group must be a number from 1 to 4096, not '5000'");
    EXPECT_EQ(message("item_group"), "--tuning: item_group must be a number from 1 to 4096, not ''");
    EXPECT_EQ(message("paths_per_item=-1"), "--tuning: paths_per_item must be a number from 1 to 65536, not '-1'");
    EXPECT_EQ(message("bvh_width=6"), "--tuning: bvh_width must be 8, 4 or 2, not 6");
    EXPECT_EQ(message(""), message(",")) << "an empty name";
}

TEST(DeviceTable, DevicesThatLackSomethingAreRefusedByASentenceThatSaysWhat) {
    EXPECT_EQ(missing_feature(able_device()), "");
    DeviceInfo device = able_device();
    device.available = false;
    EXPECT_EQ(missing_feature(device), "is not available: it is in use, switched off or broken");
    device = able_device();
    device.compiler = false;
    EXPECT_EQ(missing_feature(device), "has no OpenCL C compiler, which tristim needs");
    device = able_device();
    device.full_profile = false;
    EXPECT_NE(missing_feature(device).find("embedded profile"), std::string::npos);
    device = able_device();
    device.little_endian = !device.little_endian;
    EXPECT_NE(missing_feature(device).find("bytes"), std::string::npos);
}

TEST(DeviceTable, OpenClCBefore12IsRefused) {
    DeviceInfo device = able_device();
    for (const char* version : {"OpenCL C 1.2", "OpenCL C 1.2 ", "OpenCL C 2.0 x", "OpenCL C 3.0", "OpenCL C 10.0"}) {
        device.opencl_c = version;
        EXPECT_EQ(missing_feature(device), "") << version;
    }
    for (const char* version : {"OpenCL C 1.1 Mesa", "OpenCL C 1.0", "OpenCL C", ""}) {
        device.opencl_c = version;
        EXPECT_EQ(missing_feature(device), fmt::format("compiles '{}', but tristim needs OpenCL C 1.2", version));
    }
}

TEST(DeviceTable, EveryDeviceHereLacksNothing) {
    for (const DeviceInfo& device : list_devices()) {
        EXPECT_EQ(missing_feature(device), "") << device.name;
        EXPECT_GE(device.largest_group, 1U);
    }
}

/// Photons that cross the room of a lit box, seen by a camera: every kernel runs.
Scene lit_box() {
    Scene scene;
    scene.camera = test::look_at(V3d(0.0, 0.0, 0.9), V3d(0.0, 0.0, -1.0), V3d(0.0, 1.0, 0.0), 70.0);
    const int grey = test::add_diffuse(scene, Spectrum::constant(0.6));
    test::add_box(scene, V3d(-1.0), V3d(1.0), true, grey);
    test::add_sphere(scene, 0.4, 3, false, test::add_dielectric(scene, Spectrum::constant(1.5)));
    const int light = test::add_area_light(scene, Spectrum::constant(1.0), 1.0);
    test::add_parallelogram(scene, V3d(-0.3, 0.99, -0.3), V3d(0.6, 0.0, 0.0), V3d(0.0, 0.0, 0.6), grey, light);
    return scene;
}

std::vector<FilmPixel> film_with(const std::string& changes) {
    Device device = test::test_device();
    device.tuning = parse_tuning(changes, device.tuning);
    Renderer renderer(lit_box(), test::small_render("tristimulus:1", 33, 17, 1000, 0.2, 8), device);
    renderer.render_pass(0);
    renderer.render_pass(1);
    return renderer.film_pixels();
}

TEST(DeviceTable, TuningDoesNotChangeTheImage) {
    const std::vector<FilmPixel> usual = film_with("pixel_group=16");
    std::vector<std::string> all{"pixel_group=8,item_group=32,paths_per_item=7,sort_groups=5,loop_steps=1024"};
    if (test::long_tests())
        all.insert(all.end(), {"pixel_group=8,item_group=32", "paths_per_item=7", "sort_groups=5", "pixel_group=1"});
    for (const std::string& changes : all) {
        const std::vector<FilmPixel> other = film_with(changes);
        EXPECT_EQ(std::memcmp(usual.data(), other.data(), usual.size() * sizeof(FilmPixel)), 0) << changes;
    }
}

TEST(DeviceTable, NarrowTreesFindTheSameHits) {
    if (!test::long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const std::vector<FilmPixel> wide = film_with("bvh_width=8");
    std::vector<std::string> widths{"bvh_width=4"};
    if (test::long_tests())
        widths.emplace_back("bvh_width=2");
    for (const std::string& changes : widths) {
        const std::vector<FilmPixel> narrow = film_with(changes);
        std::size_t different = 0;
        for (std::size_t i = 0; i < wide.size(); ++i)
            different += std::memcmp(&wide[i], &narrow[i], sizeof(FilmPixel)) != 0 ? 1 : 0;
        // Rays through an edge, which either triangle may have, are too rare to be among these.
        EXPECT_EQ(different, 0U) << changes;
    }
}

} // namespace
} // namespace tristim
