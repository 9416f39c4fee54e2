// `tristim film` as people run it: numbers against closed forms, colours against Newton's published series.
#include "child_process.h"
#include "scene_folder.h"
#include "spectra/spectrum.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

namespace tristim::test {
namespace {

constexpr double kernel_error = 5e-6; // what the kernels promise for films up to 2 µm

std::string output_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "film");
    const ChildResult result = run_tristim(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_EQ(result.standard_error, "");
    return result.standard_output;
}

struct Row {
    double wavelength, angle, r_s, r_p, r, t_s, t_p, t;
};

std::vector<Row> csv_rows(std::vector<std::string> arguments) {
    arguments.emplace_back("--csv");
    std::istringstream lines(output_of(arguments));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "wavelength_nm,angle_deg,R_s,R_p,R,T_s,T_p,T");
    std::vector<Row> rows;
    while (std::getline(lines, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream cells(line);
        Row row{};
        cells >> row.wavelength >> row.angle >> row.r_s >> row.r_p >> row.r >> row.t_s >> row.t_p >> row.t;
        EXPECT_TRUE(cells && cells.peek() == std::char_traits<char>::eof()) << line;
        rows.push_back(row);
    }
    return rows;
}

Row only_row(const std::vector<std::string>& arguments) {
    const std::vector<Row> rows = csv_rows(arguments);
    EXPECT_EQ(rows.size(), 1U);
    return rows.empty() ? Row{} : rows.front();
}

nlohmann::json json_of(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    return nlohmann::json::parse(output_of(arguments));
}

TEST(FilmCommand, BareGlassAtNormalIncidenceAndBrewstersAngle) {
    const Row normal = only_row({"air|1.5", "--wavelength=550"});
    EXPECT_NEAR(normal.r_s, 0.04, kernel_error);
    EXPECT_NEAR(normal.r_p, 0.04, kernel_error);
    EXPECT_NEAR(normal.t, 0.96, kernel_error);
    // tan θ_B = n; there R_p = 0 and R_s = ((n² - 1)/(n² + 1))² (Born & Wolf 1999, section 1.5.3)
    const double brewster = std::atan(1.5) * 180.0 / std::numbers::pi;
    const Row row = only_row({"air|1.5", "--wavelength=550", fmt::format("--angle={}", brewster)});
    EXPECT_EQ(row.angle, std::stod(fmt::format("{:.10g}", brewster)));
    EXPECT_NEAR(row.r_p, 0.0, kernel_error);
    EXPECT_NEAR(row.t_p, 1.0, kernel_error);
    EXPECT_NEAR(row.r_s, std::pow(1.25 / 3.25, 2), kernel_error);
    EXPECT_NEAR(row.r, 0.5 * (row.r_s + row.r_p), 1e-8); // nine digits
}

TEST(FilmCommand, AbsorbingBaseAtNormalIncidence) {
    // ((n - 1)² + k²)/((n + 1)² + k²) (Born & Wolf 1999, section 14.2)
    const Row row = only_row({"air|0.2,3.5", "--wavelength=600"});
    const double expected = (0.64 + 12.25) / (1.44 + 12.25);
    EXPECT_NEAR(row.r, expected, kernel_error);
    EXPECT_NEAR(row.t, 1.0 - expected, kernel_error);
}

TEST(FilmCommand, TotalReflectionAndGrazingLight) {
    const std::vector<Row> rows = csv_rows({"1.5|air", "--wavelength=550", "--angle=45:90:15"});
    ASSERT_EQ(rows.size(), 4U);
    for (const Row& row : rows) { // critical at 41.8°
        EXPECT_NEAR(row.r_s, 1.0, kernel_error);
        EXPECT_NEAR(row.r_p, 1.0, kernel_error);
        EXPECT_NEAR(row.t, 0.0, kernel_error);
    }
    const Row grazing = only_row({"air|MgF2:100|1.5", "--wavelength=550", "--angle=90"});
    EXPECT_NEAR(grazing.r_s, 1.0, kernel_error);
    EXPECT_NEAR(grazing.r_p, 1.0, kernel_error);
}

/// R = ((n_s - n²)/(n_s + n²))² (Macleod 2010, section 4.2).
TEST(FilmCommand, QuarterWaveOfMagnesiumFluorideOnGlass) {
    const double n = Spectrum::named("film-MgF2-eta")(550.0), glass = 1.52;
    const Row row = only_row({fmt::format("air|MgF2:{}|1.52", 550.0 / (4.0 * n)), "--wavelength=550"});
    const double expected = std::pow((glass - n * n) / (glass + n * n), 2);
    EXPECT_NEAR(row.r, expected, kernel_error);
    EXPECT_NEAR(row.t, 1.0 - expected, kernel_error);
    // A half wave is as if absent.
    EXPECT_NEAR(only_row({fmt::format("air|MgF2:{}|1.52", 550.0 / (2.0 * n)), "--wavelength=550"}).r,
                std::pow(0.52 / 2.52, 2), kernel_error);
}

TEST(FilmCommand, LosslessStacksLoseNothing) {
    const std::vector<Row> rows =
        csv_rows({"water|MgF2:90|TiO2:0|1.9:1300|SiO2:77|BK7", "--angle=0:85:17", "--wavelength=380:780:3"});
    ASSERT_EQ(rows.size(), 6U * 134U);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].angle, 17.0 * static_cast<double>(i / 134));
        EXPECT_EQ(rows[i].wavelength, 380.0 + 3.0 * static_cast<double>(i % 134));
        EXPECT_NEAR(rows[i].r_s + rows[i].t_s, 1.0, 2.0 * kernel_error);
        EXPECT_NEAR(rows[i].r_p + rows[i].t_p, 1.0, 2.0 * kernel_error);
    }
    // A layer that absorbs does lose light.
    const Row gold = only_row({"air|Au:30|1.5", "--wavelength=450"});
    EXPECT_LT(gold.r + gold.t, 0.95);
    EXPECT_GT(gold.t, 0.05);
}

TEST(FilmCommand, JsonHoldsWhatCsvHolds) {
    const std::vector<std::string> arguments{"air|SiO2:300|Si", "--angle=0:60:30", "--wavelength=400:700:100"};
    const nlohmann::json json = json_of(arguments);
    const std::vector<Row> rows = csv_rows(arguments);
    ASSERT_EQ(json["spectrum"].size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(json["spectrum"][i]["wavelength_nm"], rows[i].wavelength);
        EXPECT_EQ(json["spectrum"][i]["angle_deg"], rows[i].angle);
        EXPECT_NEAR(json["spectrum"][i]["R_p"], rows[i].r_p, 1e-8);
        EXPECT_NEAR(json["spectrum"][i]["T"], rows[i].t, 1e-8);
    }
    EXPECT_EQ(json["stack"]["outside"], "air");
    EXPECT_EQ(json["stack"]["layers"][0]["thickness_nm"], 300.0);
    EXPECT_EQ(json["stack"]["base"], "Si");
    EXPECT_EQ(json["illuminant"], "stdillum-D65");
    ASSERT_EQ(json["colours"].size(), 3U);
    EXPECT_EQ(json["colours"][1]["angle_deg"], 30.0);
}

/// Nothing in the way: all light goes through. Chromaticities of the illuminants from CIE 15:2004, table T.3, which
/// sums over 360–830 nm; only 1e-5 of their light lies outside 380–780 nm.
TEST(FilmCommand, WhiteOfTheIlluminant) {
    const std::map<std::string, std::array<double, 2>> whites{
        {"D65", {0.31272, 0.32903}}, {"A", {0.44758, 0.40745}}, {"D50", {0.34567, 0.35851}}};
    for (const auto& [name, xy] : whites) {
        const nlohmann::json colours = json_of({"air|air", "--illuminant=" + name, "--wavelength=550"})["colours"][0];
        EXPECT_NEAR(colours["transmitted"]["XYZ"][1], 1.0, 1e-6);
        EXPECT_NEAR(colours["transmitted"]["xy"][0], xy[0], 1e-4) << name;
        EXPECT_NEAR(colours["transmitted"]["xy"][1], xy[1], 1e-4) << name;
        EXPECT_EQ(colours["reflected"]["hex"], "#000000");
        EXPECT_TRUE(colours["reflected"]["xy"].is_null());
        EXPECT_EQ(colours["transmitted"]["clipped"], name != "D65");
    }
}

TEST(FilmCommand, SweepStartsFromTheBareBase) {
    const nlohmann::json sweep = json_of({"air|SiO2:77|Si", "--sweep=0:300:100", "--angle=0:60:60"});
    EXPECT_EQ(sweep["swept_layer"], 1);
    EXPECT_FALSE(sweep.contains("spectrum"));
    ASSERT_EQ(sweep["colours"].size(), 8U);
    const nlohmann::json bare = json_of({"air|Si", "--angle=0:60:60", "--wavelength=550"});
    const nlohmann::json thick = json_of({"air|SiO2:300|Si", "--angle=0:60:60", "--wavelength=550"});
    for (const std::size_t angle : {0U, 1U}) {
        const auto expect_same = [&](const nlohmann::json& a, const nlohmann::json& b) {
            EXPECT_EQ(a["angle_deg"], b["angle_deg"]);
            for (const char* side : {"reflected", "transmitted"}) {
                for (const std::size_t c : {0U, 1U, 2U}) // each settles within 1e-5
                    EXPECT_NEAR(a[side]["XYZ"][c].get<double>(), b[side]["XYZ"][c].get<double>(), 2e-5);
            }
        };
        EXPECT_EQ(sweep["colours"][4 * angle]["thickness_nm"], 0.0);
        EXPECT_EQ(sweep["colours"][4 * angle + 3]["thickness_nm"], 300.0);
        expect_same(sweep["colours"][4 * angle], bare["colours"][angle]);
        expect_same(sweep["colours"][4 * angle + 3], thick["colours"][angle]);
    }
}

TEST(FilmCommand, SweepCsvAndTables) {
    const std::string csv = output_of({"air|1.33:0|air", "--sweep=0:200:100", "--csv"});
    EXPECT_TRUE(csv.starts_with("thickness_nm,angle_deg,X_R,Y_R,Z_R,x_R,y_R,sRGB_R,clipped_R,"
                                "X_T,Y_T,Z_T,x_T,y_T,sRGB_T,clipped_T\n0,0,0,0,0,,,#000000,0,"))
        << csv;
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);)
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), 15) << line;
    const std::string table = output_of({"air|SiO2:300|Si", "--angle=0:80:1"});
    EXPECT_NE(table.find("R_s"), std::string::npos);
    EXPECT_NE(table.find("stdillum-D65"), std::string::npos);
    EXPECT_LT(std::count(table.begin(), table.end(), '\n'), 200) << "a table is for reading";
    EXPECT_NE(output_of({"air|soap:0|air", "--sweep=0:1000:5"}).find("#"), std::string::npos);
}

/// Hue as a clockwise angle in degrees about the white D65 of the chromaticity diagram, from 430 nm: ascending from
/// violet through blue, green, yellow and red to purple.
double clockwise_hue(double x, double y) {
    constexpr std::array<double, 2> white{0.3127, 0.3290}, violet{0.1689, 0.0069};
    const auto angle = [&](double u, double v) { return std::atan2(v - white[1], u - white[0]); };
    const double turn = (angle(violet[0], violet[1]) - angle(x, y)) * 180.0 / std::numbers::pi;
    return turn < 0.0 ? turn + 360.0 : turn;
}

double hue_of_light(double lambda) {
    const std::array<double, 3> f{Spectrum::named("cie-x")(lambda), Spectrum::named("cie-y")(lambda),
                                  Spectrum::named("cie-z")(lambda)};
    const double sum = f[0] + f[1] + f[2];
    return clockwise_hue(f[0] / sum, f[1] / sum);
}

/// Ranges of hue by dominant or, for purples, complementary wavelength, rounded from Kelly 1943, "Color Designations
/// for Lights", JOSA 33, 627. Red and purple are one: the film's first reds are dark, and dark magentas are called red.
enum class Hue { Blue, Green, Yellow, Orange, RedToPurple };

Hue hue_class(double hue) {
    const double end_of_purple = hue_of_light(566.0) + 180.0;
    if (hue < hue_of_light(492.0) || hue >= end_of_purple)
        return Hue::Blue; // violet with it
    if (hue < hue_of_light(568.0))
        return Hue::Green;
    if (hue < hue_of_light(582.0))
        return Hue::Yellow;
    return hue < hue_of_light(600.0) ? Hue::Orange : Hue::RedToPurple;
}

struct NewtonStep {
    int path; ///< 2nd in nm
    const char* name;
    Hue hue;
};

/// Newton's colours in the order and at the path differences that Quincke observed (Annalen der Physik 129, 177, 1866),
/// as petrography's handbooks list them. A soap film shows them in reflection.
const std::vector<NewtonStep>& newtons_series() {
    static const std::vector<NewtonStep> series{
        {281, "straw yellow", Hue::Yellow},
        {332, "bright yellow", Hue::Yellow},
        {430, "brownish yellow", Hue::Yellow},
        {505, "reddish orange", Hue::Orange},
        {536, "red", Hue::RedToPurple},
        {551, "deep red", Hue::RedToPurple},
        {565, "purple", Hue::RedToPurple},
        {575, "violet", Hue::Blue},
        {589, "indigo", Hue::Blue},
        {664, "sky blue", Hue::Blue},
        {728, "greenish blue", Hue::Blue},
        {747, "green", Hue::Green},
        {826, "lighter green", Hue::Green},
        {843, "yellowish green", Hue::Green},
        {866, "greenish yellow", Hue::Yellow},
        {910, "pure yellow", Hue::Yellow},
        {948, "orange", Hue::Orange},
        {998, "bright orange red", Hue::RedToPurple},
        {1101, "dark violet red", Hue::RedToPurple},
        {1128, "light bluish violet", Hue::Blue},
        {1151, "indigo", Hue::Blue},
        {1258, "greenish blue", Hue::Blue},
        {1334, "sea green", Hue::Green},
        {1376, "brilliant green", Hue::Green},
        {1426, "greenish yellow", Hue::Yellow},
    };
    return series;
}

TEST(FilmCommand, SoapFilmShowsNewtonsSeries) {
    constexpr double n = 1.33;
    // A step of the sweep is 1 nm of path.
    const nlohmann::json colours =
        json_of({"air|1.33:0|air", fmt::format("--sweep=0:{}:{}", 1500 / (2 * n), 1 / (2 * n))})["colours"];
    const auto hue_at = [&](int path) {
        const nlohmann::json& xy = colours[static_cast<std::size_t>(path)]["reflected"]["xy"];
        return clockwise_hue(xy[0], xy[1]);
    };
    // Lists differ among observers and lamps: by 15 nm of path in where the first red turns violet, for one.
    constexpr int uncertainty = 30;
    double last = hue_at(newtons_series().front().path);
    double travelled = 0.0;
    for (const NewtonStep& step : newtons_series()) {
        SCOPED_TRACE(fmt::format("{} at {} nm", step.name, step.path));
        bool seen = false;
        for (int path = step.path - uncertainty; path <= step.path + uncertainty; ++path)
            seen = seen || hue_class(hue_at(path)) == step.hue;
        EXPECT_TRUE(seen) << "hue " << hue_at(step.path);
        const double hue = hue_at(step.path);
        travelled += hue < last - 180.0 ? hue + 360.0 - last : hue - last;
        EXPECT_GE(hue < last - 180.0 ? hue + 360.0 : hue, last) << "the series runs backwards";
        last = hue;
    }
    // From yellow once round to yellow, and round again.
    EXPECT_NEAR(travelled, 720.0, 60.0);
    // Before the colours, black and then, at 259 nm, "almost pure white": the brightest of all.
    EXPECT_EQ(colours[0]["reflected"]["hex"], "#000000");
    const nlohmann::json& white = colours[259]["reflected"];
    EXPECT_NEAR(white["xy"][0], 0.3127, 0.02);
    EXPECT_NEAR(white["xy"][1], 0.3290, 0.02);
    for (const nlohmann::json& row : colours)
        EXPECT_LT(row["reflected"]["XYZ"][1].get<double>(), 1.05 * white["XYZ"][1].get<double>());
}

} // namespace
} // namespace tristim::test
