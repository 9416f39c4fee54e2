// What of a render must agree for its passes to be added: host/render/identity.h.

#include "render/identity.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

namespace tristim::test {
namespace {

constexpr const char* cornell = "LookAt 0 0 -3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\n"
                                "LightSource \"point\" \"point3 from\" [0 1 0]\n"
                                "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.3 0.1 ]\n"
                                "Include \"shape.pbrt\"\n";
constexpr const char* shape = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";

class IdentityOfRenders : public testing::Test {
  protected:
    RenderIdentity of(const std::string& scene, const std::string& included, const RenderOptions& options) const {
        folder_.write("shape.pbrt", included);
        return render_identity(folder_.load(scene), options);
    }

    const SceneFolder folder_;
    const RenderOptions options_ = small_render("hero:4", 8, 6, 100, 0.1, 5);
    const RenderIdentity is_ = of(cornell, shape, options_);
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

TEST_F(IdentityOfRenders, FollowsContentAndNotTheFiles) {
    EXPECT_EQ(of(std::string("# a comment\n\n") + cornell, shape, options_), is_);
    const auto difference = [&](const std::string& scene, const std::string& included) {
        return describe_difference(of(scene, included, options_), is_);
    };
    EXPECT_EQ(difference(cornell, shape), "");
    EXPECT_NE(difference(replaced(cornell, "0.7 ", "0.8 "), shape).find("it shows another scene"), std::string::npos);
    EXPECT_NE(difference(cornell, replaced(shape, "1 0 0", "1 0 0.5")).find("it shows another scene"),
              std::string::npos);
    EXPECT_EQ(difference(replaced(cornell, "0 0 -3", "0 0 -4"), shape), "its camera is another one");
}

TEST_F(IdentityOfRenders, NamesEveryOptionThatChangesTheImage) {
    const auto difference = [&](auto&& change) {
        RenderOptions options = options_;
        change(options);
        return describe_difference(is_, of(cornell, shape, options));
    };
    using O = RenderOptions;
    const std::vector<std::pair<std::function<void(O&)>, std::string>> cases{
        {[](O& o) { o.method = parse_method("tristimulus:1"); }, "method hero:4, not tristimulus:1"},
        {[](O& o) { o.random_sequence = true; }, "sequence stratified, not random"},
        {[](O& o) { o.seed = 7; }, "seed 0, not 7"},
        {[](O& o) { o.photons_per_pass = 101; }, "photons per pass 100, not 101"},
        {[](O& o) { o.max_depth = 6; }, "maximum depth 5, not 6"},
        {[](O& o) { o.radius = 0.2; }, "initial radius 0.1, not 0.2"},
        {[](O& o) { o.radius.reset(); }, "initial radius 0.1, not auto"},
        {[](O& o) { o.radius_factor = 2.0; }, "radius factor 1, not 2"},
        {[](O& o) { o.alpha = 0.5; }, "alpha 0.6666666666666666, not 0.5"},
        {[](O& o) { o.direct_photons = true; }, "direct light sample, not photons"},
        {[](O& o) { o.statistics_radius = true; }, "radius global, not statistics"},
        {[](O& o) { o.photon_roughness = 0.5; }, "photon roughness"},
        {[](O& o) { o.fast_math = true; }, "math precise, not fast"},
        {[](O& o) { o.more_effects = parse_effects("film,point-light"); }, "extra effects none, not film"},
        {[](O& o) {
             o.region = {1, 2, 3, 4};
         },
         "region 0,0,8,6, not 1,2,4,6"},
        {[](O& o) {
             o.width = 16;
             o.region = {0, 0, 16, 6};
         },
         "resolution 8x6, not 16x6"}};
    for (const auto& [change, words] : cases) {
        const std::string clause = difference(change);
        EXPECT_EQ(clause.rfind("it was rendered with " + words, 0), 0U) << clause << " for " << words;
        EXPECT_EQ(clause.find(';'), std::string::npos) << clause;
    }
    EXPECT_EQ(difference([](O&) {}), "");
}

TEST_F(IdentityOfRenders, KernelsAndVersionMustAgree) {
    RenderOptions options = options_;
    options.kernels = folder_.path("kernels");
    std::filesystem::copy(TRISTIM_SOURCE_DIR "/kernels", options.kernels, std::filesystem::copy_options::recursive);
    EXPECT_EQ(describe_difference(of(cornell, shape, options), is_), ""); // a copy that was not changed
    std::ofstream(options.kernels + "/film.cl", std::ios::app) << "\n// changed\n";
    EXPECT_NE(describe_difference(of(cornell, shape, options), is_).find("other kernels"), std::string::npos);
    RenderIdentity old = is_;
    ASSERT_EQ(old[0].first, "version");
    old[0].second = "0.0.1";
    EXPECT_EQ(describe_difference(old, is_), "it was rendered with version 0.0.1, not " TRISTIM_VERSION);
    old.erase(old.begin());
    EXPECT_EQ(describe_difference(old, is_), "it was rendered with version unknown, not " TRISTIM_VERSION);
}

} // namespace
} // namespace tristim::test
