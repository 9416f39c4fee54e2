// `tristim spectra`: the list, a table, and plots.

#include "child_process.h"
#include "scene_folder.h"
#include "spectra/spd_file.h"
#include "spectra/spectrum.h"

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

namespace tristim::test {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

TEST(SpectraCommand, ListsEverySpectrumOnceInItsGroup) {
    const ChildResult result = run_tristim({"spectra"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_EQ(result.standard_error, "");
    const std::vector<std::string> lines = lines_of(result.standard_output);
    std::vector<std::string> names;
    std::size_t range_column = 0;
    for (const std::string& line : lines) {
        if (!line.starts_with("  "))
            continue;
        std::istringstream words(line);
        std::string name, range, unit, source;
        words >> name >> range >> unit;
        std::getline(words >> std::ws, source);
        names.push_back(name);
        EXPECT_EQ(unit, "nm") << line;
        EXPECT_GT(source.size(), 10U) << line;
        const std::size_t column = line.find(range, 2 + name.size());
        if (range_column == 0)
            range_column = column;
        EXPECT_EQ(column, range_column) << line;
        const auto [from, to] = Spectrum::named(name).range_nm();
        EXPECT_EQ(range, fmt::format("{:.0f}-{:.0f}", from, to));
    }
    std::vector<std::string> sorted = names;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, named_spectra());
    // Groups in order, F2 before F10.
    const auto position = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
    EXPECT_LT(position("cie-z"), position("stdillum-A"));
    EXPECT_LT(position("stdillum-F2"), position("stdillum-F10"));
    EXPECT_LT(position("stdillum-LED-V2"), position("illum-mercury"));
    EXPECT_LT(position("illum-sodium-lines"), position("glass-BK7"));
    EXPECT_LT(position("glass-SF11"), position("metal-Ag-eta"));
    EXPECT_LT(position("metal-TiO2-k"), position("film-SiO2-eta"));
}

TEST(SpectraCommand, PrintsATableAsAnSpdFile) {
    for (const char* name : {"stdillum-HP1", "glass-BK7", "BK7", "SiO2", "film-Si-k"}) {
        const ChildResult result = run_tristim({"spectra", name});
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        EXPECT_TRUE(result.standard_output.starts_with("# ")) << name;
        EXPECT_NE(result.standard_output.find("\n# Source: "), std::string::npos) << name;
        const Spectrum printed = parse_spd(result.standard_output, name);
        EXPECT_LE(printed.range_nm()[0], lambda_min_nm) << name;
        EXPECT_GE(printed.range_nm()[1], lambda_max_nm) << name;
    }
    const ChildResult silicon = run_tristim({"spectra", "film-Si-k"});
    const Spectrum printed = parse_spd(silicon.standard_output, "output");
    EXPECT_EQ(printed(500.0), Spectrum::named("film-Si-k")(500.0));
}

TEST(SpectraCommand, JsonDescribesAllOrSome) {
    const ChildResult all = run_tristim({"spectra", "--json"});
    EXPECT_EQ(all.exit_code, 0) << all.standard_error;
    EXPECT_EQ(nlohmann::json::parse(all.standard_output).size(), named_spectra().size());
    const ChildResult some = run_tristim({"spectra", "--json", "stdillum-D65", "Si"});
    const auto list = nlohmann::json::parse(some.standard_output);
    ASSERT_EQ(list.size(), 3U);
    EXPECT_EQ(list[0]["name"], "stdillum-D65");
    EXPECT_EQ(list[0]["range_nm"][0], 300.0);
    EXPECT_EQ(list[2]["name"], "film-Si-k");
    EXPECT_NE(list[2]["source"].get<std::string>().find("Green"), std::string::npos);
    EXPECT_NE(list[2]["description"].get<std::string>().find("silicon"), std::string::npos);
}

/// The rows of an image as RGB bytes.
struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;
};

Picture read_png(const std::string& path) {
    Picture picture;
    const auto input = OIIO::ImageInput::open(path);
    if (!input)
        return picture;
    const int channels = input->spec().nchannels;
    picture.width = input->spec().width;
    picture.height = input->spec().height;
    const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    std::vector<unsigned char> bytes(pixels * static_cast<std::size_t>(channels));
    input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, bytes.data());
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            picture.rgb.push_back(
                bytes[i * static_cast<std::size_t>(channels) + std::min(c, static_cast<std::size_t>(channels - 1))]);
    }
    return picture;
}

template <typename Is>
std::size_t count_pixels(const Picture& picture, const Is& is) {
    std::size_t count = 0;
    for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3)
        count += is(picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]) ? 1 : 0;
    return count;
}

TEST(SpectraCommand, PlotsALampWithItsSpectrumBelow) {
    const SceneFolder folder;
    const std::string file = folder.path("lamp.png");
    const ChildResult result = run_tristim({"spectra", "illum-mercury-lines", "--plot", file});
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    const Picture picture = read_png(file);
    ASSERT_GT(picture.width, 400);
    // The strip is black with a green line in it.
    const auto is_black = [](int r, int g, int b) { return r < 10 && g < 10 && b < 10; };
    const auto is_green = [](int r, int g, int b) { return g > 200 && r < 100 && b < 150; };
    EXPECT_GT(count_pixels(picture, is_black), picture.rgb.size() / 3 / 20);
    EXPECT_GT(count_pixels(picture, is_green), 20U);
    // Two curves have no strip: hardly anything is black.
    const std::string both = folder.path("both.png");
    const ChildResult two = run_tristim({"spectra", "Si", "SiO2", "--plot", both});
    ASSERT_EQ(two.exit_code, 0) << two.standard_error;
    EXPECT_LT(count_pixels(read_png(both), is_black), picture.rgb.size() / 3 / 20);
}

TEST(SpectraCommand, ErrorsAreOneSentence) {
    const SceneFolder folder;
    const std::string file = folder.path("a.png");
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
        {{"spectra", "stdilum-D65"}, "unknown spectrum \"stdilum-D65\"; did you mean stdillum-D65,"},
        {{"spectra", "stdilum-D65", "--plot", file}, "did you mean stdillum-D65,"},
        {{"spectra", "--json", "stdilum-D65"}, "did you mean stdillum-D65,"},
        {{"spectra", "Ag"}, "\"Ag\" has two tables: name metal-Ag-eta or metal-Ag-k"},
        {{"spectra", "stdillum-A", "stdillum-D50"}, "one spectrum is printed at a time"},
        {{"spectra", "--plot", file}, "--plot needs the name of at least one spectrum"},
        {{"spectra", "stdillum-A", "--plot", folder.path("a.jpeg")}, ".png"},
        {{"spectra", "stdillum-A", "--plot", folder.path("no/folder/a.png")}, "does not exist"},
    };
    for (const auto& [arguments, words] : cases) {
        const ChildResult result = run_tristim(arguments);
        EXPECT_EQ(result.exit_code, 1) << words;
        EXPECT_EQ(result.standard_output, "") << words;
        EXPECT_EQ(result.standard_error.rfind("tristim: ", 0), 0U) << result.standard_error;
        EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1);
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_FALSE(std::filesystem::exists(file)) << words;
    }
    EXPECT_EQ(run_tristim({"spectra", "--json", "--plot", file}).exit_code, 2);
}

} // namespace
} // namespace tristim::test
