#pragma once

#include <array>
#include <string>
#include <vector>

namespace tristim {

/// A curve: as many values as positions, the positions ascending. Not-a-number leaves a gap.
struct PlotSeries {
    std::string label; ///< for the legend; empty: not in the legend
    std::vector<double> x, y;
};

/// Curves over one horizontal axis.
struct Plot {
    std::string title, x_label, y_label;
    std::vector<PlotSeries> series;
    /// sRGB (gamma-encoded) in [0, 1], drawn as a strip of colours of equal width under the axes, over the curves'
    /// range of x; empty: no strip.
    std::vector<std::array<double, 3>> strip;
    std::string strip_label = {}; ///< to the strip's left; empty: none
};

/// Throws Error unless the name ends in ".png" and a file can be written there.
void check_plot_file(const std::string& png_path);

/// Draws the plot to a PNG file, which is replaced as a whole or not at all. Python with matplotlib draws
/// (plot/python.h). Throws Error if there is none, if the drawing fails, or if the file cannot be written.
void write_plot(const Plot& plot, const std::string& png_path);

} // namespace tristim
