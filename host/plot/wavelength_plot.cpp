#include "plot/wavelength_plot.h"

#include "base/error.h"
#include "image/output_file.h"
#include "plot/plot.h"
#include "plot/python.h"

#include <array>
#include <string_view>

namespace tristim {
namespace {

constexpr std::array<std::string_view, 3> script{"host/plot/style.py", "host/plot/bench_style.py",
                                                 "host/plot/wavelength_plot.py"};

} // namespace

void write_wavelength_plot(const nlohmann::ordered_json& results, const std::string& png_path) {
    check_plot_file(png_path);
    replace_file(png_path, run_python(script, results.dump(), fmt::format("draw the plot \"{}\"", png_path)));
}

} // namespace tristim
