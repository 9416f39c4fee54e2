#include "films/film_report.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace tristim {
namespace {

constexpr std::size_t most_rows = 41;
constexpr std::size_t most_angles = 7; // each with rows of its own
constexpr std::size_t fewest_rows = 9; // of an angle among several

/// Every how-manieth of `count` is shown so that at most `most` are.
std::size_t stride(std::size_t count, std::size_t most) {
    return (count + most - 1) / most;
}

std::string colour_text(const Xyz& xyz) {
    const DisplayColour shown = display_colour(xyz);
    const auto xy = chromaticity(xyz);
    const std::string xy_text = xy ? fmt::format("{:.4f} {:.4f}", (*xy)[0], (*xy)[1]) : "     -      -";
    return fmt::format("{:8.5f} {:8.5f} {:8.5f}  {}  {}{}", xyz[0], xyz[1], xyz[2], xy_text, shown.hex(),
                       shown.clipped ? " clipped" : "");
}

constexpr const char* colour_head = "       X        Y        Z       x      y  sRGB";

void append_spectrum(const FilmReport& report, std::string& text) {
    const auto out = std::back_inserter(text);
    const std::size_t angle_step = stride(report.angles_deg.size(), most_angles);
    const std::size_t angles = stride(report.angles_deg.size(), angle_step);
    const std::size_t step =
        stride(report.wavelengths_nm.size(), angles > 1 ? std::max(fewest_rows, most_rows / angles) : most_rows);
    const auto percent = [](double share) { return fmt::format("{:9.4f}", 100.0 * share); };
    for (std::size_t a = 0; a < report.angles_deg.size(); a += angle_step) {
        fmt::format_to(out, "\nAngle of incidence {:g} deg; all in %\n{:>10}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
                       report.angles_deg[a], "nm", "R_s", "R_p", "R", "T_s", "T_p", "T");
        for (std::size_t i = 0; i < report.wavelengths_nm.size(); i += step) {
            const FilmSpectrumRow& row = report.spectrum[a * report.wavelengths_nm.size() + i];
            const FilmResponse& r = row.response;
            fmt::format_to(out, "{:>10.8g}{}{}{}{}{}{}\n", row.wavelength_nm, percent(r.reflected_s),
                           percent(r.reflected_p), percent(r.reflected()), percent(r.transmitted_s),
                           percent(r.transmitted_p), percent(r.transmitted()));
        }
    }
    std::string shown;
    if (step > 1)
        shown = fmt::format("one in {} of {} wavelengths", step, report.wavelengths_nm.size());
    if (angle_step > 1)
        shown +=
            fmt::format("{}one in {} of {} angles", shown.empty() ? "" : ", ", angle_step, report.angles_deg.size());
    if (!shown.empty())
        fmt::format_to(out, "({}; --csv gives all)\n", shown);
}

void append_colours(const FilmReport& report, std::string& text) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "\nColours {}under {}, whose Y is 1\n", report.swept_layer ? "of the reflected light " : "",
                   report.illuminant);
    if (report.swept_layer) {
        const std::size_t step = stride(report.colours.size(), most_rows);
        fmt::format_to(out, "{:>8} {:>7}  {}\n", "nm", "deg", colour_head);
        for (std::size_t i = 0; i < report.colours.size(); i += step) {
            const FilmColourRow& row = report.colours[i];
            fmt::format_to(out, "{:>8.7g} {:>7.5g}  {}\n", row.thickness_nm, row.angle_deg,
                           colour_text(row.colour.reflected));
        }
        if (step > 1)
            fmt::format_to(out, "(one in {} of {}; --csv gives all, and the transmitted light)\n", step,
                           report.colours.size());
        return;
    }
    const std::size_t step = stride(report.colours.size(), most_rows);
    fmt::format_to(out, "{:>7}  {:<11} {}\n", "deg", "", colour_head);
    for (std::size_t i = 0; i < report.colours.size(); i += step) {
        const FilmColourRow& row = report.colours[i];
        fmt::format_to(out, "{:>7.5g}  {:<11} {}\n", row.angle_deg, "reflected", colour_text(row.colour.reflected));
        fmt::format_to(out, "{:>7}  {:<11} {}\n", "", "transmitted", colour_text(row.colour.transmitted));
    }
    if (step > 1)
        fmt::format_to(out, "(one in {} of {} angles; --json gives all)\n", step, report.colours.size());
}

} // namespace

std::string film_table(const FilmReport& report) {
    std::string text = report.title() + "\n";
    if (!report.swept_layer)
        append_spectrum(report, text);
    append_colours(report, text);
    return text;
}

} // namespace tristim
