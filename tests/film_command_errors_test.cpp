// `tristim film` with bad input.
#include "child_process.h"
#include "scene_folder.h"

#include <algorithm>

namespace tristim::test {
namespace {

/// Bad input: one sentence on stderr that says the words, nothing on stdout.
void expect_failure(std::vector<std::string> arguments, int exit_code, const std::string& words) {
    arguments.insert(arguments.begin(), "film");
    const ChildResult result = run_tristim(arguments);
    std::string command;
    for (const std::string& argument : arguments)
        command += argument + " ";
    SCOPED_TRACE(command);
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_EQ(result.standard_error.rfind("tristim: ", 0), 0U) << result.standard_error;
    EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1) << result.standard_error;
    EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
    EXPECT_EQ(result.standard_output, "");
}

TEST(FilmCommandErrors, BadStacks) {
    const std::vector<std::array<std::string, 2>> cases{
        {"", "has no base"},
        {"air", "has no base"},
        {"|Si", "the first medium \"\""},
        {"air|", "the base \"\""},
        {"air||Si", "layer 1"},
        {"air|SiO2|Si", "layer 1 \"SiO2\" of the stack has no thickness"},
        {"air|SiO2:|Si", "no number"},
        {"air|SiO2:thin|Si", "\"thin\""},
        {"air|SiO2:30nm|Si", "\"30nm\""},
        {"air|SiO2:-1|Si", "-1 nm"},
        {"air|SiO2:10|TiO2:-0.5|Si", "layer 2 \"TiO2:-0.5\""},
        {"air|SiO2:nan|Si", "nan nm"},
        {"air|SiO2:inf|Si", "inf nm"},
        {"air|SiO2:1e999|Si", "1e999"},
        {"air|SiO2:2e6|Si", "up to 1000000 nm"},
        {"air|:10|Si", "has no index"},
        {"air|SiO3:10|Si", "did you mean SiO2"},
        {"air|10|Sj", "layer 1 \"10\""},
        {"air|1.5:10|Sj", "the base \"Sj\""},
        {"air:5|Si", "must not have a thickness"},
        {"air|Si:5", "must not have a thickness"},
        {"Si|SiO2:10|air", "the first medium \"Si\" of the stack absorbs"},
        {"1.5,0.01|air", "absorbs"},
        {"air|1.5,-0.1:10|Si", "\"1.5,-0.1\" must be finite and not negative"},
        {"air|-1.5:10|Si", "must be positive"},
        {"air|0:10|Si", "must be positive"},
        {"air|1.5,k:10|Si", "\"1.5,k\""},
        {"air|nan:10|Si", "must be positive and finite"},
        {"air|no-such-file.spd:10|Si", "no-such-file.spd"},
        {"air|stdillum-D65:10|Si", "not a refractive index"},
    };
    for (const auto& [stack, words] : cases)
        expect_failure({stack}, 1, words);
}

TEST(FilmCommandErrors, IndexThatDoesNotCoverTheWavelengths) {
    const SceneFolder folder;
    const std::string visible = folder.write("visible.spd", "380 1.5\n780 1.5\n");
    EXPECT_EQ(run_tristim({"film", "air|" + visible + ":10|1.5", "--wavelength=380:780:100"}).exit_code, 0);
    expect_failure({"air|" + visible + ":10|1.5", "--wavelength=380:880:100"}, 1, "visible.spd");
    expect_failure({"air|SiO2:10|Si", "--wavelength=380:2000:10"}, 1, "830 nm, not over all of 380 to 2000 nm");
    const std::string narrow = folder.write("narrow.spd", "400 1.5\n700 1.5\n");
    expect_failure({"air|" + narrow + ":10|1.5", "--wavelength=500"}, 1, "narrow.spd");
    expect_failure({"air|" + folder.write("bad.spd", "400 1.5 x\n") + ":10|1.5"}, 1, "bad.spd:1");
}

TEST(FilmCommandErrors, BadOptions) {
    const std::vector<std::array<std::string, 2>> cases{
        {"--angle=-1", "0 to 90"},
        {"--angle=90.001", "0 to 90"},
        {"--angle=0:91:1", "0 to 90"},
        {"--angle=nan", "finite number"},
        {"--angle=x", "\"x\""},
        {"--angle=0:45", "FIRST:LAST:STEP"},
        {"--angle=0:10:1:2", "FIRST:LAST:STEP"},
        {"--angle=0:10:", "finite number"},
        {"--angle=0:10:0", "step must be positive"},
        {"--angle=0:10:-1", "step must be positive"},
        {"--angle=50:10:1", "below the first"},
        {"--wavelength=0", "wavelengths are positive"},
        {"--wavelength=-5:10:1", "wavelengths are positive"},
        {"--wavelength=380:780:1e-9", "more than 1000000 values"},
        {"--wavelength=400:inf:1", "finite number"},
        {"--wavelength=green", "\"green\""},
        {"--sweep=-5:5:1", "0 to 1000000 nm"},
        {"--sweep=0:2e6:1e5", "0 to 1000000 nm"},
        {"--sweep=0:100:0", "step must be positive"},
        {"--sweep=0:200000:1", "too many colours"},
        {"--illuminant=D64", "did you mean"},
        {"--illuminant=SiO2", "unknown illuminant \"SiO2\""},
        {"--illuminant=lamp.spd", "lamp.spd"},
        {"--device=no such device", "no such device"},
        {"--plot=/nonexistent/a.png", "does not exist"},
        {"--plot=a.jpeg", ".png"},
    };
    for (const auto& [option, words] : cases)
        expect_failure({"air|1.5:100|Si", option}, 1, words);
    expect_failure({"air|Si", "--angle=0:90:0.01", "--wavelength=380:780:1"}, 1, "too many");
    expect_failure({"air|SiO2:1|Si", "--sweep=0:9:1", "--layer=2"}, 1, "has 1 layer(s)");
    expect_failure({"air|1.4:10|1.5", "--wavelength=1e-40"}, 1, "no finite reflectance");
    expect_failure({"air|Si", "--sweep=0:9:1"}, 1, "has 0 layer(s)");
    expect_failure({"air|SiO2:1|Si", "--sweep=0:9:1", "--angle=0:9:1", "--plot=a.png"}, 1, "one --angle");
}

TEST(FilmCommandErrors, BadUsage) {
    expect_failure({}, 2, "stack");
    expect_failure({"air|Si", "--csv", "--json"}, 2, "--csv");
    expect_failure({"air|SiO2:1|Si", "--sweep=0:9:1", "--wavelength=500"}, 2, "--wavelength");
    expect_failure({"air|SiO2:1|Si", "--layer=1"}, 2, "--sweep");
    expect_failure({"air|SiO2:1|Si", "--sweep=0:9:1", "--layer=0"}, 2, "--layer");
    expect_failure({"air|Si", "--math=sloppy"}, 2, "sloppy");
    expect_failure({"air|Si", "--no-such-flag"}, 2, "--no-such-flag");
    expect_failure({"air|Si", "air|Ge"}, 2, "air|Ge");
}

/// Standard output on a full disk; PoCL's own files are smaller.
TEST(FilmCommandErrors, OutputThatCannotBeWritten) {
    ChildLimits limits;
    limits.file_size = 4U << 20U;
    const ChildResult result = run_tristim({"film", "air|Si", "--wavelength=380:780:0.005", "--csv"}, {}, limits);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.standard_error.find("cannot write the results"), std::string::npos) << result.standard_error;
}

} // namespace
} // namespace tristim::test
