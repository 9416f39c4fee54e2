#include "report/report_page.h"

#include "base/embedded_files.h"
#include "base/error.h"
#include "base/read_file.h"
#include "image/error_map.h"
#include "image/output_file.h"
#include "spectra/colour.h"

#include <OpenImageIO/strutil.h>

#include <filesystem>
#include <string_view>

namespace tristim {
namespace {

using nlohmann::ordered_json;

std::string data_uri(const std::string& path) {
    const std::string bytes = read_whole_file(path);
    if (!bytes.starts_with("\x89PNG\r\n\x1a\n"))
        fail("the report needs the image \"{}\", which is no PNG file", path);
    return "data:image/png;base64," + OIIO::Strutil::base64_encode(bytes);
}

/// Every image that the results name, by that name.
ordered_json images(const ordered_json& results, const std::string& folder) {
    ordered_json uris = ordered_json::object();
    const auto add = [&](const ordered_json& owner, const char* key) {
        const std::string name = owner.value(key, "");
        if (!name.empty() && !uris.contains(name))
            uris[name] = data_uri((std::filesystem::path(folder) / name).string());
    };
    for (const ordered_json& scene : results.at("scenes")) {
        add(scene, "image");
        for (const ordered_json& run : scene.at("runs")) {
            add(run, "image");
            add(run, "error_map");
        }
    }
    return uris;
}

/// The colours of error maps, from the least error to the greatest, in equal steps of log error.
ordered_json error_map_scale_bar() {
    constexpr int steps = 32;
    ordered_json colours = ordered_json::array();
    for (int i = 0; i <= steps; ++i) {
        const Rgb rgb = error_map_colour(static_cast<double>(i) / steps);
        colours.push_back(fmt::format("rgb({:.0f} {:.0f} {:.0f})", 255 * rgb[0], 255 * rgb[1], 255 * rgb[2]));
    }
    return {{"decades", error_map_decades}, {"colours", colours}};
}

/// JSON that can stand inside an HTML script element: there "<" may open a tag ("</script>", "<!--"), and in JSON it
/// stands in strings alone, where an escape means the same.
std::string script_json(const ordered_json& json) {
    const std::string text = json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) {
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    }
    return safe;
}

/// The template with each {{name}} replaced by the data of that name, or else by the embedded file.
std::string fill_template(std::string_view page, const std::map<std::string, std::string>& data) {
    std::string filled;
    while (true) {
        const std::size_t open = page.find("{{");
        filled += page.substr(0, open);
        if (open == std::string_view::npos)
            return filled;
        const std::size_t close = page.find("}}", open);
        const std::string name(page.substr(open + 2, close - open - 2));
        const auto found = data.find(name);
        filled += found != data.end() ? std::string_view(found->second) : embedded_files().at(name);
        page.remove_prefix(close + 2);
    }
}

} // namespace

void write_report_page(const ordered_json& results, const std::string& folder) {
    const ordered_json data{
        {"results", results}, {"images", images(results, folder)}, {"errorMap", error_map_scale_bar()}};
    const std::string page =
        fill_template(embedded_files().at("host/report/report.html"), {{"data", script_json(data)}});
    replace_file((std::filesystem::path(folder) / "report.html").string(), page);
}

} // namespace tristim
