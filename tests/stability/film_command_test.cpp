// `tristim film` over the whole range that it accepts, against the oracle.
#include "child_process.h"
#include "selftest/film_oracle.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <sstream>

namespace tristim::test {
namespace {

constexpr double promised = 5e-6;
constexpr double promised_of_100 = 5e-4; ///< as of the case "1 to 100 quarter waves" of `tristim selftest`

struct Stack {
    std::vector<oracle::Layer> layers;
    double base_n, base_k;
    double bound = promised;
};

/// Every row that the command prints for a stack.
void expect_exact_rows(const Stack& stack, const std::string& angles) {
    constexpr double lambda = 550.0;
    std::string text = "air";
    for (const oracle::Layer& layer : stack.layers)
        text += fmt::format("|{},{}:{}", layer.n, layer.k, layer.thickness);
    text += fmt::format("|{},{}", stack.base_n, stack.base_k);
    const ChildResult result = run_tristim({"film", text, "--csv", "--wavelength=550", "--angle=" + angles});
    ASSERT_EQ(result.exit_code, 0) << text << ": " << result.standard_error;
    std::istringstream lines(result.standard_output);
    std::string row;
    std::getline(lines, row);
    std::size_t rows = 0;
    for (; std::getline(lines, row); ++rows) {
        std::replace(row.begin(), row.end(), ',', ' ');
        std::istringstream cells(row);
        double wavelength = 0, angle = 0, r_s = 0, r_p = 0, r = 0, t_s = 0, t_p = 0;
        cells >> wavelength >> angle >> r_s >> r_p >> r >> t_s >> t_p;
        ASSERT_TRUE(cells) << row;
        const auto cosine = angle == 90.0 ? 0.0F : static_cast<float>(std::cos(angle * std::numbers::pi / 180.0));
        const oracle::FilmOptics exact =
            oracle::film(1.0, stack.layers, stack.base_n, stack.base_k, lambda, cosine, true);
        EXPECT_NEAR(r_s, exact.reflected_s, stack.bound) << text << " at " << angle;
        EXPECT_NEAR(r_p, exact.reflected_p, stack.bound) << text << " at " << angle;
        EXPECT_NEAR(t_s, exact.transmitted_s, stack.bound) << text << " at " << angle;
        EXPECT_NEAR(t_p, exact.transmitted_p, stack.bound) << text << " at " << angle;
    }
    EXPECT_GT(rows, 0U) << text;
}

/// Values that are floats, so that the command means what the oracle is given; the wavelength too.
TEST(FilmStability, CommandTakesTheWholeRange) {
    std::vector<oracle::Layer> hundred;
    for (int i = 0; i < 100; ++i)
        hundred.push_back({i % 2 == 0 ? 58.5 : 94.0, i % 2 == 0 ? 2.375 : 1.4375, 0.0});
    const Stack none{{{1e6, 1.0, 0.0}}, 1.0, 0.0};
    const std::vector<Stack> stacks{none,
                                    {{{0.0, 2.375, 0.0}}, 1.5, 0.0},
                                    {{{0.0009765625, 2.375, 0.0}}, 1.5, 0.0},
                                    {{{1e6, 1.4375, 0.0}}, 4.0, 0.03125},
                                    {{{1e6, 1.5, 0.0}, {1e6, 2.375, 0.0}}, 1.5, 0.0},
                                    {{{50.0, 2.0, 10.0}}, 0.0625, 1000.0},
                                    {{{1.0, 0.0625, 1000.0}}, 1.5, 0.0},
                                    {hundred, 1.5, 0.0, promised_of_100}};
    for (const Stack& stack : stacks)
        expect_exact_rows(stack, "0:89.9999:44.99995");
    expect_exact_rows(none, "90");
}

} // namespace
} // namespace tristim::test
