#include "wavelength_passes.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tristim::kernel_test {
namespace {

WavelengthBins emission_of(const std::vector<std::pair<Spectrum, Passes::Use>>& spectra) {
    WavelengthBins emission{};
    for (const auto& [spectrum, use] : spectra) {
        const WavelengthBins bins = spectrum.bins();
        if (use == Passes::Use::Emission)
            std::transform(emission.begin(), emission.end(), bins.begin(), emission.begin(), std::plus<>());
    }
    return emission;
}

} // namespace

Passes::Passes(const Method& method, bool random_sequence, const WavelengthBins& emission,
               const std::vector<std::pair<Spectrum, Use>>& spectra)
    : layout_(wavelength_layout(method)),
      program_(build_program(test_device(), "wavelengths.cl", method_macros(method, random_sequence), {})),
      kernel_(program_, "wavelengths"), sampler_(upload(sampler_table(method, emission))) {
    SpectrumTable table;
    for (const auto& [spectrum, use] : spectra)
        table.add(spectrum, use);
    values_ = upload(table.values(method));
    smooth_ = upload(table.smooth());
    rows_ = table.rows();
    output_ = make_buffer<float>(static_cast<std::size_t>((4 + rows_) * layout_.padded()));
}

Passes::Passes(const Method& method, bool random_sequence, const std::vector<std::pair<Spectrum, Use>>& spectra)
    : Passes(method, random_sequence, emission_of(spectra), spectra) {}

const std::vector<float>& Passes::operator()(std::uint32_t pass) {
    cl_uint index = 0;
    set_argument(kernel_, index++, seed);
    set_argument(kernel_, index++, pass);
    set_argument(kernel_, index++, sampler_);
    set_argument(kernel_, index++, values_);
    set_argument(kernel_, index++, smooth_);
    set_argument(kernel_, index++, rows_);
    set_argument(kernel_, index++, output_);
    test_device().queue.enqueueNDRangeKernel(kernel_, ::cl::NullRange,
                                             ::cl::NDRange(static_cast<std::size_t>(layout_.padded())));
    current_ = output_.read(test_device());
    return current_;
}

Spectrum bumpy() {
    std::vector<double> lambda, values;
    for (int i = 350; i <= 800; i += 10) {
        lambda.push_back(i);
        values.push_back(0.5 + 0.4 * std::sin(i / 23.0));
    }
    return Spectrum::piecewise_linear(lambda, values);
}

std::vector<WavelengthSample> draw_samples(const SamplerInput& input, std::uint32_t seed, std::size_t passes,
                                           const Spectrum& light, const Spectrum& reflectance) {
    const ::cl::Program program = build_test_program(R"(
#include "wavelengths.cl"
kernel void draw(uint seed, const global float* sampler_table, const global float* light,
                 const global float* reflectance, global float* out) {
    const int item = (int)get_global_id(0);
    const Sampler sampling = {seed, (uint)(item / W), sampler_table, sampler_table + 3 * LAMBDA_BINS};
    float3 weight;
    const float lambda = sample_wavelength(&sampling, item % W, &weight);
    out[6 * item] = lambda;
    vstore3(weight, 0, out + 6 * item + 1);
    out[6 * item + 4] = bins_at(light, 0, lambda);
    out[6 * item + 5] = bins_at(reflectance, 1, lambda);
}
)",
                                                     method_macros(input.method, input.random_sequence));
    const auto floats = [](const WavelengthBins& bins) { return std::vector<float>(bins.begin(), bins.end()); };
    const std::size_t count = passes * static_cast<std::size_t>(input.method.wavelengths());
    static_assert(sizeof(WavelengthSample) == 6 * sizeof(float));
    const Buffer<WavelengthSample> output = make_buffer<WavelengthSample>(count);
    run(program, "draw", count, seed, upload(sampler_table(input.method, input.emission)), upload(floats(light.bins())),
        upload(floats(reflectance.bins())), output);
    return output.read(test_device());
}

std::vector<float> draw_positions(bool random_sequence, bool rotated, std::uint32_t seed, std::uint32_t pass,
                                  std::uint32_t parts) {
    const ::cl::Program program = build_test_program(R"(
#include "wavelength_sampling.h"
kernel void positions(uint seed, uint pass, uint parts, int rotated, global float* out) {
    const uint j = (uint)get_global_id(0);
    out[j] = unit_float(rotated ? rotated_position(seed, pass, j, parts) : sample_position(seed, pass, j, parts));
}
)",
                                                     {{"SEQUENCE_RANDOM", random_sequence ? "1" : "0"}});
    const Buffer<float> output = make_buffer<float>(parts);
    run(program, "positions", parts, seed, pass, parts, cl_int{rotated ? 1 : 0}, output);
    return output.read(test_device());
}

} // namespace tristim::kernel_test
