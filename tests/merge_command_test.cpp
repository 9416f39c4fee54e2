// `tristim merge`: passes of one image that were rendered apart.

#include "child_process.h"
#include "image/read_image.h"
#include "render/checkpoint.h"
#include "scene_folder.h"

#include <OpenImageIO/imageio.h>

#include <cstring>

namespace tristim::test {
namespace {

constexpr const char* scene_text = "Camera \"perspective\"\n"
                                   "Film \"rgb\" \"integer xresolution\" [ 8 ] \"integer yresolution\" [ 6 ]\n"
                                   "WorldBegin\n"
                                   "LightSource \"point\" \"point3 from\" [ 0 1 0 ] \"spectrum I\" \"stdillum-A\"\n"
                                   "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.3 0.1 ]\n"
                                   "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 ]\n";

TEST(MergeCommand, ARenderInPiecesIsTheWholeImage) {
    const SceneFolder folder;
    const std::string scene = folder.write("scene.pbrt", scene_text);
    const auto path = [&](const std::string& name) { return folder.path(name); };
    const auto render = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", scene, "--photons=256", "--space=xyz", "--quiet"});
        const ChildResult result = run_tristim(more);
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    };
    render({"--pass-range=0:3", "--checkpoint", path("a.exr"), "--outfile", path("i.exr")});
    render({"--pass-range=5:9", "--checkpoint", path("c.exr"), "--outfile", path("c-image.exr")});
    const ChildResult merged = run_tristim({"merge", path("c.exr"), path("a.exr"), "--checkpoint", path("ac.exr"),
                                            "--outfile", path("ac-image.exr"), "--outfile", path("ac.png")});
    EXPECT_EQ(merged.exit_code, 0) << merged.standard_error;
    EXPECT_NE(merged.standard_error.find("7 passes (0:3,5:9)"), std::string::npos) << merged.standard_error;
    EXPECT_TRUE(std::filesystem::exists(path("ac.png")));
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path("ac-image.exr"));
    ASSERT_TRUE(input) << OIIO::geterror();
    EXPECT_EQ(input->spec().get_int_attribute("tristim:passes"), 7);
    EXPECT_EQ(input->spec().get_string_attribute("tristim:pass_ranges"), "0:3,5:9");
    EXPECT_EQ(input->spec().get_string_attribute("tristim:method"), "tristimulus:1");

    // A resumed render fills the gap and goes on.
    render({"--passes=10", "--resume", path("ac.exr"), "--outfile", path("filled.exr")});
    render({"--passes=10", "--outfile", path("whole.exr")});
    EXPECT_EQ(read_checkpoint(path("ac.exr")).sums.passes.text(), "0:10");
    const XyzImage filled = read_exr(path("filled.exr")), whole = read_exr(path("whole.exr"));
    ASSERT_EQ(filled.xyz.size(), whole.xyz.size());
    EXPECT_EQ(std::memcmp(filled.xyz.data(), whole.xyz.data(), whole.xyz.size() * sizeof(whole.xyz[0])), 0);

    const auto refused = [&](std::vector<std::string> arguments, const std::string& words) {
        arguments.insert(arguments.begin(), "merge");
        const ChildResult result = run_tristim(arguments);
        EXPECT_EQ(result.exit_code, 1) << words;
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_FALSE(std::filesystem::exists(path("no.exr")));
    };
    refused({path("a.exr"), path("c.exr"), path("a.exr"), "--outfile", path("no.exr")}, "both hold the passes 0:3");
    refused({path("a.exr"), path("i.exr"), "--outfile", path("no.exr")}, "was not written by tristim's --checkpoint");
    refused({path("a.exr"), "--outfile", path("c.exr")}, "cannot write an image to");
    refused({path("a.exr"), "--checkpoint", path("c.exr")}, "is there already");
    refused({path("a.exr")}, "--outfile or --checkpoint");
}

} // namespace
} // namespace tristim::test
