#include "selftest/optics_cases.h"

#include "opencl/buffer.h"

#include <cmath>
#include <numbers>

namespace tristim::selftest {
namespace optics {

std::vector<cl_float4> run(const Setting& setting, const ::cl::Program& program, const char* kernel,
                           std::vector<cl_float4> inputs, std::size_t per_input, std::size_t per_output,
                           const std::vector<::cl::Buffer>& before) {
    // One size of work-groups for all: PoCL compiles a kernel for each.
    constexpr std::size_t group = 16;
    const std::size_t count = inputs.size() / per_input;
    const std::size_t items = (count + group - 1) / group * group;
    const std::vector<cl_float4> last(inputs.end() - static_cast<std::ptrdiff_t>(per_input), inputs.end());
    while (inputs.size() < items * per_input)
        inputs.insert(inputs.end(), last.begin(), last.end());
    const Buffer<cl_float4> in(setting.device, "selftest input", inputs);
    const Buffer<cl_float4> out(setting.device, "selftest output", items * per_output);
    ::cl::Kernel tested(program, kernel);
    cl_uint index = 0;
    for (const ::cl::Buffer& buffer : before)
        tested.setArg(index++, buffer);
    tested.setArg(index++, in.cl());
    tested.setArg(index, out.cl());
    setting.device.queue.enqueueNDRangeKernel(tested, ::cl::NullRange, ::cl::NDRange(items), ::cl::NDRange(group));
    return out.read(setting.device, count * per_output);
}

Vector Random::direction() {
    const double z = 2.0 * (*this)() - 1.0, phi = 2.0 * std::numbers::pi * (*this)();
    const double across = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {across * std::cos(phi), across * std::sin(phi), z};
}

cl_float4 float4_of(const Vector& v, double w) {
    return {{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(w)}};
}

cl_float4 float4_of(double x, double y, double z, double w) {
    return {{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), static_cast<float>(w)}};
}

Vector vector_of(const cl_float4& v) {
    return {v.s[0], v.s[1], v.s[2]};
}

std::vector<float> ratio_steps(double first, double last, int count) {
    std::vector<float> steps;
    for (int i = 0; i <= count; ++i)
        steps.push_back(static_cast<float>(first * std::pow(last / first, static_cast<double>(i) / count)));
    return steps;
}

std::vector<float> cosines() {
    std::vector<float> list = ratio_steps(1.0, 1e-8, 64);
    for (int degrees = 1; degrees < 90; degrees += 2)
        list.push_back(static_cast<float>(std::cos(degrees * std::numbers::pi / 180.0)));
    for (const float step : {1e-7F, 1e-6F, 1e-5F, 1e-4F, 1e-3F}) // near the normal
        list.push_back(1.0F - step);
    list.push_back(0.0F);
    return list;
}

std::vector<float> relative_indices() {
    std::vector<float> list = ratio_steps(0.1, 10.0, 40);
    for (const float step : ratio_steps(1e-7, 0.1, 24)) {
        list.push_back(1.0F + step);
        list.push_back(1.0F - step);
    }
    list.push_back(1.0F);
    return list;
}

} // namespace optics

Macros optics_macros() {
    return {{"LANES", "4"}};
}

Macros path_macros() {
    return {{"W", "4"},        {"LANES", "4"},          {"BLOCKS", "1"},   {"HAS_DIELECTRIC", "1"},
            {"HAS_FILM", "1"}, {"HAS_DISPERSION", "1"}, {"HAS_ROUGH", "1"}};
}

std::vector<Case> optics_cases() {
    const Programs cores =
        built_once([](const Setting& setting) { return build(setting, "optics.cl", optics_macros()); });
    const Programs paths =
        built_once([](const Setting& setting) { return build(setting, "optics_paths.cl", path_macros()); });
    std::vector<Case> all;
    for (const auto& part : {fresnel_cases(cores), direction_cases(cores), microfacet_cases(cores), path_cases(paths)})
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

} // namespace tristim::selftest
