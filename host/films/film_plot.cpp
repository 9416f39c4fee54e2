#include "films/film_report.h"
#include "image/tone_mapping.h"

#include <algorithm>
#include <fmt/format.h>

namespace tristim {
namespace {

constexpr std::size_t most_curves = 8;

/// sRGB of each colour, all made brighter by the one factor that brings the brightest channel to 1: the colours of weak
/// reflections are dark. Black stays black.
std::vector<std::array<double, 3>> bright_strip(const std::vector<FilmColourRow>& colours, double& gain) {
    double brightest = 0.0;
    std::vector<std::array<double, 3>> strip;
    for (const FilmColourRow& row : colours) {
        strip.push_back(xyz_to_rgb(row.colour.reflected));
        brightest = std::max(brightest, *std::max_element(strip.back().begin(), strip.back().end()));
    }
    gain = brightest > 0.0 && brightest < 1.0 ? 1.0 / brightest : 1.0;
    for (auto& colour : strip) {
        for (double& channel : colour)
            channel = srgb_encode(std::clamp(gain * channel, 0.0, 1.0));
    }
    return strip;
}

void add_strip(const FilmReport& report, Plot& plot) {
    double gain = 1.0;
    plot.strip = bright_strip(report.colours, gain);
    plot.strip_label = gain > 1.05 ? fmt::format("reflected,\n{:.2g} times\nas bright", gain) : "reflected";
}

Plot sweep_plot(const FilmReport& report) {
    Plot plot;
    plot.title = fmt::format("{} at {:g}° under {}", report.title(), report.angles_deg.front(), report.illuminant);
    plot.x_label = fmt::format("thickness of {} (nm)", report.stack.layers[*report.swept_layer].name);
    plot.y_label = "reflected light (Y of the illuminant: 1)";
    const std::array<const char*, 3> names{"X", "Y", "Z"};
    for (std::size_t c = 0; c < 3; ++c) {
        PlotSeries& series = plot.series.emplace_back();
        series.label = names[c];
        for (const FilmColourRow& row : report.colours) {
            series.x.push_back(row.thickness_nm);
            series.y.push_back(row.colour.reflected[c]);
        }
    }
    add_strip(report, plot);
    return plot;
}

/// Curves over wavelength or angle from rows `first`, `first + 1`, … of one angle, or of all angles.
template <typename Value>
PlotSeries curve(const FilmReport& report, const std::string& label, std::size_t first, std::size_t count,
                 Value value) {
    const bool over_angle = report.wavelengths_nm.size() == 1;
    PlotSeries series{label, {}, {}};
    for (std::size_t i = first; i < first + count; ++i) {
        const FilmSpectrumRow& row = report.spectrum[i];
        series.x.push_back(over_angle ? row.angle_deg : row.wavelength_nm);
        series.y.push_back(value(row.response));
    }
    return series;
}

/// Without absorption in the layers T is 1 - R, and would only take room from a small R.
bool transmittance_is_the_rest(const FilmReport& report) {
    constexpr double visible = 1e-3;
    return std::all_of(report.spectrum.begin(), report.spectrum.end(), [](const FilmSpectrumRow& row) {
        return row.response.reflected() + row.response.transmitted() > 1.0 - visible;
    });
}

void add_response_curves(const FilmReport& report, bool polarised, Plot& plot) {
    const std::size_t count = report.spectrum.size();
    const auto add = [&](const char* label, auto value) {
        plot.series.push_back(curve(report, label, 0, count, value));
    };
    add("R", [](const FilmResponse& r) { return r.reflected(); });
    if (polarised) {
        add("R_s", [](const FilmResponse& r) { return double{r.reflected_s}; });
        add("R_p", [](const FilmResponse& r) { return double{r.reflected_p}; });
    }
    plot.y_label = "reflectance R (transmittance is the rest)";
    if (transmittance_is_the_rest(report))
        return;
    plot.y_label = "reflectance R, transmittance T";
    add("T", [](const FilmResponse& r) { return r.transmitted(); });
    if (polarised) {
        add("T_s", [](const FilmResponse& r) { return double{r.transmitted_s}; });
        add("T_p", [](const FilmResponse& r) { return double{r.transmitted_p}; });
    }
}

Plot spectrum_plot(const FilmReport& report) {
    Plot plot;
    const std::size_t wavelengths = report.wavelengths_nm.size(), angles = report.angles_deg.size();
    plot.title = report.title();
    if (wavelengths == 1) {
        plot.title += fmt::format(" at {:g} nm", report.wavelengths_nm.front());
        plot.x_label = "angle of incidence (°)";
        add_response_curves(report, true, plot);
        add_strip(report, plot);
        plot.strip_label += "\nunder\n" + report.illuminant;
        return plot;
    }
    plot.x_label = "wavelength (nm)";
    if (angles == 1) {
        plot.title += fmt::format(" at {:g}°", report.angles_deg.front());
        add_response_curves(report, report.angles_deg.front() > 0.0, plot);
        return plot;
    }
    plot.y_label = "reflectance, mean of s and p";
    const std::size_t curves = std::min(angles, most_curves);
    for (std::size_t i = 0; i < curves; ++i) {
        const std::size_t a = i * (angles - 1) / (curves - 1); // first and last among them
        plot.series.push_back(curve(report, fmt::format("{:g}°", report.angles_deg[a]), a * wavelengths, wavelengths,
                                    [](const FilmResponse& r) { return r.reflected(); }));
    }
    return plot;
}

} // namespace

Plot film_plot(const FilmReport& report) {
    return report.swept_layer ? sweep_plot(report) : spectrum_plot(report);
}

} // namespace tristim
