#include "plot/plot.h"

#include "base/error.h"
#include "image/output_file.h"
#include "plot/python.h"

#include <nlohmann/json.hpp>
#include <string_view>

namespace tristim {
namespace {

constexpr std::array<std::string_view, 2> script{"host/plot/style.py", "host/plot/plot.py"};

std::string to_json(const Plot& plot) {
    nlohmann::json series = nlohmann::json::array();
    for (const PlotSeries& curve : plot.series) {
        if (curve.x.size() != curve.y.size())
            fail("the curve \"{}\" of a plot has {} positions but {} values", curve.label, curve.x.size(),
                 curve.y.size());
        series.push_back({{"label", curve.label}, {"x", curve.x}, {"y", curve.y}});
    }
    const nlohmann::json object{{"title", plot.title}, {"x_label", plot.x_label}, {"y_label", plot.y_label},
                                {"series", series},    {"strip", plot.strip},     {"strip_label", plot.strip_label}};
    return object.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

} // namespace

void check_plot_file(const std::string& png_path) {
    if (!png_path.ends_with(".png"))
        fail("the plot \"{}\" must be a .png file", png_path);
    check_output_file(png_path);
}

void write_plot(const Plot& plot, const std::string& png_path) {
    check_plot_file(png_path);
    replace_file(png_path, run_python(script, to_json(plot), fmt::format("draw the plot \"{}\"", png_path)));
}

} // namespace tristim
