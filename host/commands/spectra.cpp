#include "commands/spectra.h"

#include "base/error.h"
#include "image/tone_mapping.h"
#include "plot/plot.h"
#include "spectra/colour.h"
#include "spectra/complex_index.h"
#include "spectra/spectrum.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tristim {
namespace {

struct SpectraOptions {
    std::vector<std::string> names;
    std::string plot;
    bool json = false;
};

struct Group {
    const char* title;
    std::vector<std::string> prefixes;
};

const std::vector<Group>& groups() {
    static const std::vector<Group> all{{"Colour matching functions", {"cie-"}},
                                        {"Illuminants (scaled to Y = 1 where they are used)", {"stdillum-", "illum-"}},
                                        {"Glasses", {"glass-"}},
                                        {"Metals", {"metal-"}},
                                        {"Other materials of films and substrates", {"film-"}}};
    return all;
}

/// "F2" before "F10": digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b) {
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (!is_digit(a[i]) || !is_digit(b[j])) {
            if (a[i] != b[j])
                return a[i] < b[j];
            ++i;
            ++j;
            continue;
        }
        const auto run = [&](const std::string& text, std::size_t& at) {
            const std::size_t begin = at;
            while (at < text.size() && is_digit(text[at]))
                ++at;
            return std::stoi(text.substr(begin, at - begin));
        };
        const int left = run(a, i), right = run(b, j);
        if (left != right)
            return left < right;
    }
    return a.size() < b.size();
}

std::vector<std::string> members(const Group& group) {
    std::vector<std::string> names;
    for (const std::string& prefix : group.prefixes) {
        std::vector<std::string> part;
        for (const std::string& name : named_spectra()) {
            if (name.starts_with(prefix))
                part.push_back(name);
        }
        std::sort(part.begin(), part.end(), natural_less);
        names.insert(names.end(), part.begin(), part.end());
    }
    return names;
}

/// What the head of a table says: its first line, and the first line of its source.
struct Head {
    std::string description, source;
};

Head read_head(const std::string& name) {
    constexpr std::string_view comment = "# ", source = "Source: ";
    Head head;
    for (std::string_view text = named_spectrum_text(name); text.starts_with(comment);) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(comment.size(), end - comment.size());
        if (head.description.empty())
            head.description = line;
        else if (head.source.empty() && line.starts_with(source))
            head.source = line.substr(source.size());
        text.remove_prefix(end + 1);
    }
    return head;
}

std::string range_text(const std::string& name) {
    const auto [from, to] = Spectrum::named(name).range_nm();
    return fmt::format("{:.0f}-{:.0f} nm", from, to);
}

void print_list() {
    std::size_t name_width = 0;
    for (const std::string& name : named_spectra())
        name_width = std::max(name_width, name.size());
    for (const Group& group : groups()) {
        fmt::print("{}\n", group.title);
        for (const std::string& name : members(group))
            fmt::print("  {:<{}}  {:<11}  {}\n", name, name_width, range_text(name), read_head(name).source);
        fmt::print("\n");
    }
    fmt::print(
        "The index of a material goes by its bare name: SiO2 for film-SiO2-eta (k = 0), Ag for metal-Ag-eta and\n"
        "metal-Ag-k, BK7 for glass-BK7; of two, the film comes first.\n");
}

nlohmann::ordered_json describe(const std::string& name) {
    const Head head = read_head(name);
    return {{"name", name},
            {"description", head.description},
            {"source", head.source},
            {"range_nm", Spectrum::named(name).range_nm()}};
}

void print_json(const std::vector<std::string>& names) {
    auto list = nlohmann::ordered_json::array();
    for (const std::string& name : names)
        list.push_back(describe(name));
    fmt::print("{}\n", list.dump(2));
}

/// The tables that a name on the command line means: its own, or those of a material.
std::vector<std::string> tables_of(const std::string& name) {
    const std::vector<std::string> tables = index_tables(name);
    return tables.empty() ? std::vector<std::string>{name} : tables;
}

void print_table(const std::string& name) {
    const std::vector<std::string> tables = tables_of(name);
    if (tables.size() > 1)
        fail("\"{}\" has two tables: name {} or {}, or draw both with --plot", name, tables[0], tables[1]);
    fmt::print("{}", named_spectrum_text(tables.front()));
}

/// Illuminants as the mean over each nanometre, which is what the renderer knows of them and in which lines of any
/// width have their place; all else as it is.
PlotSeries curve(const std::string& name) {
    const Spectrum spectrum = Spectrum::named(name);
    PlotSeries series{name, {}, {}};
    const auto add = [&](double lambda, double value) {
        series.x.push_back(lambda);
        series.y.push_back(value);
    };
    if (!is_illuminant(name)) {
        for (int i = 0; i <= lambda_bins; ++i)
            add(lambda_min_nm + i, spectrum(lambda_min_nm + i));
        return series;
    }
    const auto bins = spectrum.bins();
    add(lambda_min_nm, bins.front());
    for (int i = 0; i < lambda_bins; ++i)
        add(lambda_min_nm + i + 0.5, bins[static_cast<std::size_t>(i)]);
    add(lambda_max_nm, bins.back());
    return series;
}

/// The light as a prism spreads it: each nanometre's colour, moved into sRGB by adding white, the brightest channel of
/// all 1.
std::vector<std::array<double, 3>> spectrogram(const Spectrum& light) {
    const auto bins = light.bins();
    std::vector<std::array<double, 3>> strip(lambda_bins);
    double brightest = 0.0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
        const auto& f = cie_bins();
        strip[i] = xyz_to_rgb({bins[i] * f[0][i], bins[i] * f[1][i], bins[i] * f[2][i]});
        const double white = std::max(0.0, -*std::min_element(strip[i].begin(), strip[i].end()));
        for (double& channel : strip[i]) {
            channel += white;
            brightest = std::max(brightest, channel);
        }
    }
    for (auto& colour : strip) {
        for (double& channel : colour)
            channel = srgb_encode(channel / brightest);
    }
    return strip;
}

std::string value_label(const std::vector<std::string>& tables) {
    const auto all = [&](auto&& is) { return std::all_of(tables.begin(), tables.end(), is); };
    if (all(is_illuminant))
        return "relative power, means over 1 nm (Y = 1)";
    if (all([](const std::string& name) { return name.starts_with("cie-"); }))
        return "value";
    if (std::none_of(tables.begin(), tables.end(), is_illuminant))
        return "refractive index";
    return "value";
}

void draw(const std::vector<std::string>& names, const std::string& file) {
    std::vector<std::string> tables;
    for (const std::string& name : names)
        std::ranges::copy(tables_of(name), std::back_inserter(tables));
    Plot plot;
    plot.title = fmt::format("{}", fmt::join(names, ", "));
    plot.x_label = "wavelength (nm)";
    plot.y_label = value_label(tables);
    for (const std::string& table : tables)
        plot.series.push_back(curve(table));
    if (tables.size() == 1)
        plot.series.front().label.clear(); // the title says it
    if (tables.size() == 1 && is_illuminant(tables.front()))
        plot.strip = spectrogram(Spectrum::named(tables.front()));
    write_plot(plot, file);
}

void spectra(const SpectraOptions& options) {
    if (!options.plot.empty()) {
        if (options.names.empty())
            fail("--plot needs the name of at least one spectrum");
        draw(options.names, options.plot);
    } else if (options.json) {
        std::vector<std::string> names;
        for (const std::string& name : options.names)
            std::ranges::copy(tables_of(name), std::back_inserter(names));
        print_json(options.names.empty() ? named_spectra() : names);
    } else if (options.names.empty()) {
        print_list();
    } else if (options.names.size() == 1) {
        print_table(options.names.front());
    } else {
        fail("one spectrum is printed at a time; draw several with --plot");
    }
}

} // namespace

void add_spectra_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("spectra", "List the named spectra; print or draw them");
    const auto options = std::make_shared<SpectraOptions>();
    command->add_option("name", options->names, "Print this one as a .spd file [list all]")->type_name("NAME");
    CLI::Option* plot = command
                            ->add_option("--plot", options->plot,
                                         "Draw the named spectra from 380 to 780 nm; a material's name draws n and k")
                            ->type_name("FILE.png");
    command->add_flag("--json", options->json, "Print names, descriptions, sources and ranges as JSON")->excludes(plot);
    command->callback([options] { spectra(*options); });
}

} // namespace tristim
