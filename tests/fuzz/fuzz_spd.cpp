// .spd files through each of their readers: spectra, refractive indices and illuminants.

#include "line_mutator.h"
#include "scratch.h"

#include "films/illuminant.h"
#include "spectra/colour.h"
#include "spectra/complex_index.h"

#include <algorithm>
#include <cmath>

namespace tristim::fuzz {

namespace {

void check(const Spectrum& spectrum) {
    const auto [from, to] = spectrum.range_nm();
    require(from <= to, "a range ascends");
    for (const double lambda : {from, to, 0.5 * (from + to), lambda_min_nm, lambda_max_nm})
        require(std::isfinite(static_cast<float>(spectrum(lambda))), "values are finite");
    const WavelengthBins bins = spectrum.bins();
    require(std::all_of(bins.begin(), bins.end(), [](double bin) { return std::isfinite(static_cast<float>(bin)); }),
            "bins are finite");
    for (const double channel : spectrum_to_xyz(spectrum))
        require(std::isfinite(channel), "colours are finite");
    const double least = spectrum.minimum(from, to);
    require(std::isfinite(least) && least <= spectrum(from) && least <= spectrum(to), "the minimum is no more");
    require(!spectrum.is_constant() || spectrum(lambda_min_nm) == spectrum(lambda_max_nm), "a constant is constant");
}

} // namespace

} // namespace tristim::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tristim;
    using namespace tristim::fuzz;
    static const Scratch scratch;
    const std::string path = scratch.write("table.spd", {reinterpret_cast<const char*>(data), size});
    expect_value_or_error([&] { check(Spectrum::read_spd(path)); });
    expect_value_or_error([&] { check(parse_index(path).eta); });
    expect_value_or_error([&] { check(parse_index("1.5," + path).k); });
    expect_value_or_error([&] { check(find_illuminant(path).spectrum); });
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    return tristim::fuzz::mutate_text(data, size, max_size, seed);
}
