#include "render/scene_buffers.h"

#include "base/stopwatch.h"
#include "render/sobol.h"

namespace tristim {

SceneBuffers::SceneBuffers(const Device& device, const FlatScene& scene) {
    const Stopwatch stopwatch;
    bvh_ = build_bvh(scene.soup, device.tuning.bvh_width);
    bvh_seconds_ = stopwatch.seconds();
    constants_ = Buffer<SceneConstants>(device, "scene constants", std::vector{scene.constants});
    nodes_ = Buffer<std::uint32_t>(device, "BVH nodes", bvh_.nodes.words());
    leaves_ = Buffer<std::uint32_t>(device, "BVH leaves", bvh_.leaves.words());
    triangles_ = Buffer<Triangle>(device, "triangles", scene.triangles);
    attributes_ = Buffer<float>(device, "vertex attributes", scene.attributes);
    materials_ = Buffer<SurfaceMaterial>(device, "materials", scene.materials);
    film_layers_ = Buffer<SceneFilmLayer>(device, "film layers", scene.film_layers);
    textures_ = Buffer<SceneTexture>(device, "textures", scene.textures);
    texels_ = Buffer<float>(device, "texels", scene.texels);
    lights_ = Buffer<SceneLight>(device, "lights", scene.lights);
    light_cdf_ = Buffer<float>(device, "light CDF", scene.light_cdf);
    sobol_table_ = Buffer<std::uint32_t>(device, "Sobol' table", sobol_table());
}

cl_uint SceneBuffers::bind(::cl::Kernel& kernel, const Buffer<float>& pass_table, const RayRecorder& recorder) const {
    cl_uint index = 0;
    for (const ::cl::Buffer* buffer :
         {&constants_.cl(), &nodes_.cl(), &leaves_.cl(), &triangles_.cl(), &attributes_.cl(), &materials_.cl(),
          &film_layers_.cl(), &textures_.cl(), &texels_.cl(), &lights_.cl(), &light_cdf_.cl(), &pass_table.cl(),
          &sobol_table_.cl(), &recorder.rays().cl(), &recorder.count().cl()})
        kernel.setArg(index++, *buffer);
    return index;
}

std::vector<std::pair<std::string, std::uint64_t>> SceneBuffers::sizes() const {
    std::vector<std::pair<std::string, std::uint64_t>> sizes;
    const auto add = [&sizes](const auto& buffer) { sizes.emplace_back(buffer.name(), buffer.bytes()); };
    add(constants_);
    add(nodes_);
    add(leaves_);
    add(triangles_);
    add(attributes_);
    add(materials_);
    add(film_layers_);
    add(textures_);
    add(texels_);
    add(lights_);
    add(light_cdf_);
    add(sobol_table_);
    return sizes;
}

} // namespace tristim
