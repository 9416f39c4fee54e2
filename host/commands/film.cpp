#include "commands/film.h"

#include "base/error.h"
#include "commands/device_options.h"
#include "films/film_colour.h"
#include "films/film_report.h"
#include "films/illuminant.h"
#include "films/value_range.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace tristim {
namespace {

constexpr std::size_t max_rows = 1'000'000;
constexpr std::size_t max_colours = 100'000;

struct FilmOptions {
    std::string stack;
    std::string angle = "0";
    std::string wavelength = "380:780:5";
    std::string sweep;
    std::size_t layer = 1;
    std::string illuminant = "D65";
    std::string plot;
    std::string device;
    std::string math = "precise";
    bool csv = false;
    bool json = false;
};

/// The options and what they say together, checked.
FilmReport plan(const FilmOptions& options) {
    FilmReport report;
    report.stack = parse_film_stack(options.stack);
    report.angles_deg = parse_range(options.angle, "angle");
    if (report.angles_deg.front() < 0.0 || report.angles_deg.back() > 90.0)
        fail("bad angle \"{}\": angles of incidence go from 0 to 90 degrees", options.angle);
    report.math = options.math;
    if (options.sweep.empty()) {
        report.wavelengths_nm = parse_range(options.wavelength, "wavelength");
        if (!(report.wavelengths_nm.front() > 0.0))
            fail("bad wavelength \"{}\": wavelengths are positive", options.wavelength);
        check_stack_covers(report.stack, report.wavelengths_nm.front(), report.wavelengths_nm.back());
        if (report.wavelengths_nm.size() * report.angles_deg.size() > max_rows)
            fail("{} wavelengths at {} angles are too many: at most {} together", report.wavelengths_nm.size(),
                 report.angles_deg.size(), max_rows);
    } else {
        report.thicknesses_nm = parse_range(options.sweep, "sweep");
        if (report.thicknesses_nm.front() < 0.0 || report.thicknesses_nm.back() > max_layer_thickness_nm)
            fail("bad sweep \"{}\": thicknesses go from 0 to {} nm", options.sweep, max_layer_thickness_nm);
        if (options.layer > report.stack.layers.size())
            fail("the sweep is to vary layer {}, but the stack \"{}\" has {} layer(s)", options.layer, options.stack,
                 report.stack.layers.size());
        report.swept_layer = options.layer - 1;
        if (!options.plot.empty() && report.angles_deg.size() > 1)
            fail("--plot draws a --sweep at one --angle, not at {}", report.angles_deg.size());
    }
    if (report.angles_deg.size() * std::max<std::size_t>(1, report.thicknesses_nm.size()) > max_colours)
        fail("{} thicknesses at {} angles are too many colours: at most {}",
             std::max<std::size_t>(1, report.thicknesses_nm.size()), report.angles_deg.size(), max_colours);
    return report;
}

void evaluate(const FilmEvaluator& evaluator, FilmColours& colours, FilmReport& report) {
    for (const double angle : report.angles_deg) {
        if (report.swept_layer) {
            const auto swept = colours.colours(angle, *report.swept_layer, report.thicknesses_nm);
            for (std::size_t i = 0; i < swept.size(); ++i)
                report.colours.push_back({angle, report.thicknesses_nm[i], swept[i]});
            continue;
        }
        const std::vector<FilmResponse> responses = evaluator.evaluate(report.wavelengths_nm, angle);
        for (std::size_t i = 0; i < responses.size(); ++i)
            report.spectrum.push_back({report.wavelengths_nm[i], angle, responses[i]});
        report.colours.push_back({angle, 0.0, colours.colour(angle)});
    }
}

void print(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        fail("cannot write the results: {}", std::strerror(errno));
}

void film(const FilmOptions& options) {
    FilmReport report = plan(options);
    const Illuminant illuminant = find_illuminant(options.illuminant);
    report.illuminant = illuminant.name;
    if (!options.plot.empty())
        check_plot_file(options.plot);
    const Device device = open_device(options.device);
    report.device = device.info.name;
    double from = lambda_min_nm, to = lambda_max_nm;
    if (!report.wavelengths_nm.empty()) {
        from = std::min(from, report.wavelengths_nm.front());
        to = std::max(to, report.wavelengths_nm.back());
    }
    const FilmEvaluator evaluator(device, report.stack, from, to, options.math == "fast");
    FilmColours colours(evaluator, illuminant.spectrum);
    report.white = colours.white();
    evaluate(evaluator, colours, report);
    if (!options.plot.empty())
        write_plot(film_plot(report), options.plot);
    if (options.csv || options.json)
        print(options.csv ? film_csv(report) : film_json(report));
    else if (options.plot.empty())
        print(film_table(report));
}

constexpr const char* footer =
    "STACK is OUTSIDE|INDEX:NM|...|BASE, say 'air|MgF2:99.6|BK7': the medium that light comes from, which must not\n"
    "absorb, any number of layers with their thickness in nm, and the base. An index is a name ('tristim spectra'\n"
    "lists them; air and vacuum are 1), a number n, n,k of n + ik, or a .spd file of n (or two, of n and k).\n\n"
    "The kernel function that renders films evaluates the stack, at the very wavelengths asked for. R_s and T_s are "
    "for\n"
    "light polarised across the plane of incidence, R_p and T_p in it, R and T for unpolarised light; T is the power\n"
    "that enters the base. At 90 degrees stands the limit of grazing light.\n\n"
    "Colours are integrals from 380 to 780 nm, whatever --wavelength says: in steps of 1 nm or less, four to a "
    "fringe,\n"
    "halved until X, Y and Z hold still within 1e-5; lines of lamps keep energy and place. XYZ has Y = 1 for the "
    "light\n"
    "itself; sRGB is not adapted to the light's white, and 'clipped' marks colours that sRGB cannot show.\n\n"
    "CSV has the columns wavelength_nm,angle_deg,R_s,R_p,R,T_s,T_p,T (shares, not percent), or the colours by\n"
    "thickness of a --sweep; JSON has spectra and colours. Plots need Python with matplotlib (Debian:\n"
    "python3-matplotlib); TRISTIM_PYTHON names another Python.";

} // namespace

void add_film_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("film", "Reflectance, transmittance and colour of a thin-film stack");
    const auto o = std::make_shared<FilmOptions>();
    command->add_option("stack", o->stack, "The stack, such as 'air|SiO2:300|Si'")->required()->type_name("STACK");
    command->add_option("--angle", o->angle, "Angles of incidence in degrees")
        ->type_name("A|A0:A1:STEP")
        ->capture_default_str();
    CLI::Option* wavelength = command->add_option("--wavelength", o->wavelength, "Wavelengths in nm")
                                  ->type_name("L|L0:L1:STEP")
                                  ->capture_default_str();
    CLI::Option* sweep =
        command->add_option("--sweep", o->sweep, "Vary a layer's thickness in nm and give the colours by thickness")
            ->type_name("T0:T1:STEP")
            ->excludes(wavelength);
    command->add_option("--layer", o->layer, "The layer that --sweep varies, 1 for the outermost")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}))
        ->capture_default_str()
        ->needs(sweep);
    command->add_option("--illuminant", o->illuminant, "Light of the colours: a named illuminant or a .spd file")
        ->type_name("NAME")
        ->capture_default_str();
    CLI::Option* csv = command->add_flag("--csv", o->csv, "Print CSV instead of a table");
    command->add_flag("--json", o->json, "Print JSON instead of a table")->excludes(csv);
    command->add_option("--plot", o->plot, "Draw curves, with colours where they fit; no table")->type_name("FILE.png");
    add_device_option(*command, o->device);
    add_math_option(*command, o->math);
    command->footer(footer);
    command->callback([o] { film(*o); });
}

} // namespace tristim
