// Host and device must agree on every struct of kernels/shared_types.h: sizes, and offsets of fields.

#include "opencl/buffer.h"
#include "opencl/program.h"
#include "shared_types.h"

#include <cstddef>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

struct Field {
    std::string type;
    std::string name;
    std::size_t struct_size;
    std::size_t offset;
};

#define FIELD(type, name)                                                                                              \
    Field {                                                                                                            \
#type, #name, sizeof(type), offsetof(type, name)                                                               \
    }

/// The last field of each struct and one after each change of meaning: an offset that is right there is right between.
const std::vector<Field>& fields() {
    static const std::vector<Field> list{
        FIELD(Ray, origin_x),
        FIELD(Ray, t_max),
        FIELD(Ray, direction_x),
        FIELD(Ray, unused),
        FIELD(RayHit, t),
        FIELD(RayHit, triangle),
        FIELD(RayHit, v),
        FIELD(SceneConstants, camera_x),
        FIELD(SceneConstants, lens_radius),
        FIELD(SceneConstants, corner_x),
        FIELD(SceneConstants, right_x),
        FIELD(SceneConstants, down_x),
        FIELD(SceneConstants, centre_x),
        FIELD(SceneConstants, lens_right_x),
        FIELD(SceneConstants, lens_up_x),
        FIELD(SceneConstants, focal_distance),
        FIELD(SceneConstants, light_count),
        FIELD(SceneConstants, region_x),
        FIELD(SceneConstants, radius),
        FIELD(SceneConstants, region_y),
        FIELD(SceneConstants, region_width),
        FIELD(SceneConstants, infinite_light),
        FIELD(SceneConstants, image_height),
        FIELD(Triangle, v0_x),
        FIELD(Triangle, material),
        FIELD(Triangle, edge1_x),
        FIELD(Triangle, light),
        FIELD(Triangle, edge2_x),
        FIELD(Triangle, attributes),
        FIELD(Triangle, normal_x),
        FIELD(Triangle, normal_z),
        FIELD(SurfaceMaterial, kind),
        FIELD(SurfaceMaterial, dispersive),
        FIELD(SurfaceMaterial, k),
        FIELD(SurfaceMaterial, film),
        FIELD(SurfaceMaterial, film_texture),
        FIELD(SurfaceMaterial, alpha_u),
        FIELD(SurfaceMaterial, takes_photons),
        FIELD(SurfaceMaterial, internal_reflectance),
        FIELD(SurfaceMaterial, internal_step),
        FIELD(SceneFilmLayer, thickness),
        FIELD(SceneFilmLayer, k),
        FIELD(SceneFilmLayer, unused),
        FIELD(SceneTexture, kind),
        FIELD(SceneTexture, first_texel),
        FIELD(SceneTexture, corners),
        FIELD(SceneTexture, to_texture),
        FIELD(SceneLight, kind),
        FIELD(SceneLight, spectrum),
        FIELD(SceneLight, scale),
        FIELD(SceneLight, probability),
        FIELD(SceneLight, position_x),
        FIELD(SceneLight, direction_x),
        FIELD(SceneLight, edge1_x),
        FIELD(SceneLight, edge2_x),
        FIELD(SceneLight, cos_total_width),
        FIELD(SceneLight, cos_falloff_start),
        FIELD(SceneLight, area),
        FIELD(SceneLight, two_sided),
        FIELD(SceneLight, extent),
        FIELD(VisiblePoint, x),
        FIELD(VisiblePoint, normal),
        FIELD(VisiblePoint, slot),
        FIELD(VisiblePoint, radius),
        FIELD(VisiblePoint, shadow_rays),
        FIELD(Photon, x),
        FIELD(Photon, normal),
        FIELD(Photon, flux_x),
        FIELD(Photon, slot),
        FIELD(VisibleSurface, material),
        FIELD(VisibleSurface, outgoing),
        FIELD(VisibleSurface, thickness),
        FIELD(PhotonSurface, side),
        FIELD(PhotonSurface, incident),
        FIELD(FilmPixel, sum_high),
        FIELD(FilmPixel, sum_middle),
        FIELD(FilmPixel, sum_low),
        FIELD(FilmPixel, square_high),
        FIELD(FilmPixel, square_low),
        FIELD(FilmPixel, samples),
        FIELD(FilmPixel, rejected),
        FIELD(FilmPixel, statistics_radius),
        FIELD(FilmPixel, shadow_rays),
    };
    return list;
}

#undef FIELD

/// The same of the BVH's structs, whose rows are `width` values long.
std::vector<Field> bvh_fields(std::size_t width) {
    const auto row = [width](int rows) { return sizeof(float) * width * static_cast<std::size_t>(rows); };
    const auto node = [&](const char* name, int number) {
        return Field{"BvhNode", name, row(BVH_NODE_ROWS), row(number)};
    };
    const auto leaf = [&](const char* name, int number) {
        return Field{"BvhLeaf", name, row(BVH_LEAF_ROWS), row(number)};
    };
    return {node("low_x", BVH_LOW),
            node("low_y", BVH_LOW + 1),
            node("low_z", BVH_LOW + 2),
            node("high_x", BVH_HIGH),
            node("high_y", BVH_HIGH + 1),
            node("high_z", BVH_HIGH + 2),
            node("child", BVH_CHILD),
            leaf("v0_x", BVH_V0),
            leaf("v0_y", BVH_V0 + 1),
            leaf("v0_z", BVH_V0 + 2),
            leaf("v1_x", BVH_V1),
            leaf("v1_y", BVH_V1 + 1),
            leaf("v1_z", BVH_V1 + 2),
            leaf("v2_x", BVH_V2),
            leaf("v2_y", BVH_V2 + 1),
            leaf("v2_z", BVH_V2 + 2),
            leaf("id", BVH_ID)};
}

void expect_layout(const std::vector<Field>& fields, const std::string& build_options) {
    std::string source = flatten_kernel_source("shared_types.h") + "kernel void probe_layout(global uint* sizes, "
                                                                   "global uint* offsets) {\n";
    for (std::size_t i = 0; i < fields.size(); ++i)
        source += fmt::format("    {{ {0} s; sizes[{2}] = (uint)sizeof(s); offsets[{2}] = (uint)((char*)&s.{1} - "
                              "(char*)&s); }}\n",
                              fields[i].type, fields[i].name, i);
    source += "}\n";

    const Device device = open_device("");
    ::cl::Program program(device.context, source);
    ASSERT_NO_THROW(program.build(device.device, ("-cl-std=CL1.2" + build_options).c_str()))
        << program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device);
    const Buffer<cl_uint> sizes(device, "sizes", fields.size());
    const Buffer<cl_uint> offsets(device, "offsets", fields.size());
    ::cl::Kernel kernel(program, "probe_layout");
    kernel.setArg(0, sizes.cl());
    kernel.setArg(1, offsets.cl());
    device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(1));
    const std::vector<cl_uint> device_sizes = sizes.read(device);
    const std::vector<cl_uint> device_offsets = offsets.read(device);
    for (std::size_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(device_sizes[i], fields[i].struct_size) << fields[i].type;
        EXPECT_EQ(device_offsets[i], fields[i].offset) << fields[i].type << "." << fields[i].name;
    }
}

TEST(SharedTypes, HaveTheSameLayoutOnTheDevice) {
    expect_layout(fields(), "");
}

TEST(SharedTypes, RowsOfTheBvhLieWhereTheHostPutsThem) {
    for (const std::size_t width : {8U, 4U, 2U})
        expect_layout(bvh_fields(width), fmt::format(" -D BVH_WIDTH={}", width));
}

} // namespace
} // namespace tristim
