#include "bench/regions.h"

#include "base/error.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace tristim {
namespace {

constexpr const char* whole_image = "image";

NamedRegion parse_named_region(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const bool good_name = !name.empty() && name != whole_image && std::all_of(name.begin(), name.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    });
    if (equals == std::string::npos || !good_name)
        fail("bad region '{}': expected NAME=X0,Y0,X1,Y1 with a name of letters, digits, - and _ other than {}", text,
             whole_image);
    return {name, parse_region(std::string_view(text).substr(equals + 1))};
}

bool has(const std::vector<NamedRegion>& regions, const std::string& name) {
    return std::any_of(regions.begin(), regions.end(), [&](const NamedRegion& region) { return region.name == name; });
}

/// From the scene's own resolution to that of the render; pixels cut in part count.
Region scaled(const Region& region, const RenderSettings& from, const RenderOptions& to) {
    const auto scale = [](int value, int size, int new_size, int round_up) {
        return static_cast<int>((std::int64_t{value} * new_size + round_up * (size - 1)) / size);
    };
    const int x0 = scale(region.x, from.width, to.width, 0);
    const int y0 = scale(region.y, from.height, to.height, 0);
    return {x0, y0, scale(region.x + region.width, from.width, to.width, 1) - x0,
            scale(region.y + region.height, from.height, to.height, 1) - y0};
}

std::vector<NamedRegion> kept_regions(const Scene& scene) {
    const std::string path = std::filesystem::path(scene.path).replace_extension(".regions").string();
    std::vector<NamedRegion> regions;
    std::ifstream file(path);
    int number = 0;
    for (std::string line; std::getline(file, line);) {
        ++number;
        line.erase(std::min(line.find('#'), line.size()));
        std::erase_if(line, [](unsigned char c) { return std::isspace(c) != 0; });
        if (line.empty())
            continue;
        try {
            regions.push_back(parse_named_region(line));
        } catch (const Error& error) {
            fail("{}:{}: {}", path, number, error.what());
        }
        const Region frame{0, 0, scene.settings.width, scene.settings.height};
        if (!contains(frame, regions.back().region))
            fail("{}:{}: the region '{}' is not inside the scene's {}x{} image", path, number, line, frame.width,
                 frame.height);
        const std::string name = regions.back().name;
        if (has({regions.begin(), regions.end() - 1}, name))
            fail("{}:{}: the region {} comes twice", path, number, name);
    }
    return regions;
}

} // namespace

std::vector<NamedRegion> named_regions(const Scene& scene, const RenderOptions& options,
                                       const std::vector<std::string>& given) {
    std::vector<NamedRegion> wanted;
    for (const std::string& text : given) {
        const NamedRegion region = parse_named_region(text);
        if (!contains(options.region, region.region)) {
            const Region& r = options.region;
            fail("the region '{}' is not inside the rendered pixels {},{},{},{}", text, r.x, r.y, r.x + r.width,
                 r.y + r.height);
        }
        if (has(wanted, region.name))
            fail("the region {} comes twice", region.name);
        wanted.push_back(region);
    }
    std::vector<NamedRegion> regions{{whole_image, options.region}};
    for (const NamedRegion& kept : kept_regions(scene)) {
        const Region region = scaled(kept.region, scene.settings, options);
        if (contains(options.region, region) && !has(wanted, kept.name))
            regions.push_back({kept.name, region});
    }
    regions.insert(regions.end(), wanted.begin(), wanted.end());
    return regions;
}

} // namespace tristim
