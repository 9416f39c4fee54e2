// Values that are not finite: each kernel leaves them out, counts them and does the rest as if they had never been.
// They are brought in by changing a line of the kernel.

#include "bvh/ray_tracer.h"
#include "child_process.h"
#include "image/read_image.h"
#include "kernel_harness.h"
#include "render/renderer.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <OpenImageIO/imageio.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

namespace tristim::test {
namespace {

constexpr std::uint32_t paths = 2048;
constexpr std::uint32_t capacity = 1024;

/// A closed box, lit from within: every photon path meets walls until it ends.
Scene lit_box() {
    Scene scene;
    scene.camera = look_at({0, 0, -0.9}, {0, 0, 1}, {0, 1, 0}, 60.0);
    add_box(scene, {-1, -1, -1}, {1, 1, 1}, true, add_diffuse(scene, Spectrum::constant(0.6)));
    Light light;
    light.kind = Light::Kind::Point;
    light.emission = Spectrum::constant(1.0);
    light.position = V3d(0.1, 0.2, 0.3);
    scene.lights.push_back(light);
    return scene;
}

/// The source of a kernel with some words in place of others, which must appear in it once.
std::string changed(const std::string& file, const std::string& from, const std::string& to) {
    std::string source = flatten_kernel_source(file);
    const std::size_t at = source.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    EXPECT_EQ(source.find(from, at + 1), std::string::npos) << from << " appears twice";
    return source.replace(at, from.size(), to);
}

/// A kernel that no longer tells what is finite.
std::string blind(const std::string& source) {
    const std::string test = "return (as_uint(x) << 1) < 0xff000000u;";
    std::string result = source;
    const std::size_t at = result.find(test);
    EXPECT_NE(at, std::string::npos);
    return result.replace(at, test.size(), "return true;");
}

/// Text with NAN and INF written as bits: compilers may do as they like with the names.
std::string bits_in(std::string text) {
    for (const auto& [name, bits] :
         {std::pair("NAN", "as_float(0x7fc00000u)"), std::pair("INF", "as_float(0x7f800000u)")}) {
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name))
            text.replace(at, std::strlen(name), bits);
    }
    return text;
}

/// The box on the device, and the two passes over it by programs of a test's own.
class NonFinite : public testing::TestWithParam<bool> {
  protected:
    NonFinite() {
        options_ = small_render("tristimulus:1", 16, 16, static_cast<int>(paths), 0.2, 8);
        options_.fast_math = GetParam();
        scene_ = std::make_shared<const DeviceScene>(lit_box(), options_, test_device());
        Renderer renderer(scene_, options_, test_device());
        renderer.render_pass(0);
        table_ = renderer.pass_table();
        macros_ = method_macros(options_.method, false);
        for (const Macros& more : {effect_macros(scene_->effects()), traversal_macros(scene_->buffers().bvh())})
            macros_.insert(macros_.end(), more.begin(), more.end());
        macros_.emplace_back("MAX_DEPTH", "8");
    }

    ::cl::Kernel kernel(const std::string& source, const char* name, bool direct_photons) const {
        Macros macros = macros_;
        macros.emplace_back("DIRECT_PHOTONS", direct_photons ? "1" : "0");
        return {
            build_program_from_text(test_device(), std::string(name) + ".cl", source, macros, {options_.fast_math, {}}),
            name};
    }

    template <typename... Arguments>
    void launch(::cl::Kernel kernel, std::size_t items, const Arguments&... arguments) const {
        const Device& device = test_device();
        const Buffer<float> table(device, "table", table_);
        const RayRecorder recorder(device, 0);
        cl_uint index = scene_->buffers().bind(kernel, table, recorder);
        (kernel_test::set_argument(kernel, index++, arguments), ...);
        device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(items));
        device.queue.finish();
    }

    struct Photons {
        std::vector<Photon> stored; ///< item by item
        std::uint64_t non_finite = 0;
    };

    Photons trace_photons(const std::string& source) const {
        const Device& device = test_device();
        constexpr std::uint32_t items = paths / 64;
        const Buffer<Photon> photons(device, "photons", std::size_t{items} * capacity);
        const Buffer<PhotonSurface> surfaces(device, "surfaces", 0);
        const Buffer<float> spectra(device, "spectra", 0);
        const Buffer<std::uint32_t> counts(device, "counts", items);
        const Buffer<std::uint64_t> rays(device, "rays", std::vector<std::uint64_t>(items, 0U));
        const Buffer<std::uint32_t> non_finite = zero_counts();
        launch(kernel(source, "photon_pass", true), items, 0U, 0U, paths, capacity, photons, surfaces, spectra, counts,
               rays, non_finite);
        Photons result;
        const std::vector<Photon> all = photons.read(device);
        const std::vector<std::uint32_t> of_items = counts.read(device);
        for (std::uint32_t item = 0; item < items; ++item) {
            EXPECT_LE(of_items[item], capacity);
            const auto begin = all.begin() + static_cast<std::ptrdiff_t>(item * capacity);
            result.stored.insert(result.stored.end(), begin, begin + of_items[item]);
        }
        result.non_finite = non_finite.read(device)[2 * NON_FINITE_PHOTON];
        return result;
    }

    struct Eye {
        std::vector<VisiblePoint> points;
        std::uint64_t non_finite = 0;
    };

    Eye trace_eye(const std::string& source) const {
        const Device& device = test_device();
        constexpr std::size_t pixels = 256;
        const Buffer<float> radii(device, "radii", std::vector<float>(pixels, 0.2F));
        const Buffer<FilmPixel> film(device, "film", pixels);
        const Buffer<VisiblePoint> points(device, "points", pixels);
        const Buffer<VisibleSurface> surfaces(device, "surfaces", 0);
        const Buffer<float> spectra(device, "spectra", 0);
        const Buffer<std::uint32_t> non_finite = zero_counts();
        launch(kernel(source, "eye_pass", false), pixels, 0U, 0U, radii, 1.0F, film, points, surfaces, spectra,
               non_finite);
        return {points.read(device), non_finite.read(device)[2 * NON_FINITE_EYE]};
    }

    static Buffer<std::uint32_t> zero_counts() {
        return {test_device(), "counts", std::vector<std::uint32_t>(2 * NON_FINITE_COUNTS, 0U)};
    }

    RenderOptions options_;
    std::shared_ptr<const DeviceScene> scene_;
    std::vector<float> table_;
    Macros macros_;
};

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool is_bad(std::uint32_t path) {
    return path % 7 == 3;
}
/// The photon pass with a statement for these paths, where they have all they start with.
std::string with_bad_paths(const std::string& what) {
    const std::string start = "if (carried_total(&path.weight) <= 0.0f)";
    return changed("photon_pass.cl", start, "if (path_number % 7u == 3u) { " + what + " }\n" + start);
}

std::uint64_t bad_paths() {
    std::uint64_t count = 0;
    for (std::uint32_t path = 0; path < paths; ++path)
        count += is_bad(path) ? 1U : 0U;
    return count;
}

TEST_P(NonFinite, PhotonsAreLeftOutAndCounted) {
    EXPECT_EQ(trace_photons(flatten_kernel_source("photon_pass.cl")).non_finite, 0U);
    const Photons without = trace_photons(with_bad_paths("return;"));
    ASSERT_GT(without.stored.size(), 500U);
    EXPECT_EQ(without.non_finite, 0U);
    // One fault after the other, so that a program has all of them.
    const Photons with = trace_photons(with_bad_paths(bits_in("switch (path_number / 7u % 4u) {\n"
                                                              "case 0: path.weight.scale = NAN; break;\n"
                                                              "case 1: path.weight.spectrum.block[0].y = INF; break;\n"
                                                              "case 2: path.direction.y = NAN; break;\n"
                                                              "default: path.origin.x = NAN;\n}")));
    EXPECT_EQ(with.non_finite, bad_paths());
    EXPECT_TRUE(same_bytes(with.stored, without.stored));
    // A photon whose own position is bad, on a path that is good.
    const Photons placed = trace_photons(changed("photon_pass.cl", "!is_finite3(it->point)",
                                                 bits_in("!is_finite3(index % 2u == 1u ? (float3)(NAN) : it->point)")));
    EXPECT_GT(placed.non_finite, 0U);
}

/// The test above can fail: a kernel that takes everything for finite stores what it should not.
TEST_P(NonFinite, PhotonsOfABlindKernelAreBad) {
    if (GetParam())
        GTEST_SKIP() << "with relaxed math a compiler may make anything of what is not finite";
    const Photons with = trace_photons(blind(with_bad_paths(bits_in("path.weight.spectrum.block[0].y = NAN;"))));
    EXPECT_EQ(with.non_finite, 0U);
    EXPECT_TRUE(std::any_of(with.stored.begin(), with.stored.end(),
                            [](const Photon& p) { return !std::isfinite(p.flux_x + p.flux_y + p.flux_z); }));
}

TEST_P(NonFinite, CameraPathsLoseNoMoreThanWhatIsBad) {
    const Eye good = trace_eye(flatten_kernel_source("eye_pass.cl"));
    EXPECT_EQ(good.non_finite, 0U);
    const std::string start = "path.weight.scale = 1.0f;";
    const std::string if_pixel = start + "if (pixel % 16u == 5u) ";
    const std::string bad_weight = if_pixel + bits_in("path.weight.scale = NAN;");
    const std::string direct = "add_radiance(path, diffuse_direct_light(";
    struct Fault {
        std::string from, to;
        std::uint64_t counted; ///< for each bad pixel
        bool keeps_point;
    };
    for (const Fault& fault :
         {Fault{start, bad_weight, 2, false}, // direct light and the point
          Fault{start, if_pixel + bits_in("path.direction.x = NAN;"), 1, false},
          Fault{direct,
                bits_in("add_radiance(path, get_global_id(0) % 16u == 5u ? (float3)(NAN) : diffuse_direct_light("), 1,
                true}}) {
        const Eye bad = trace_eye(changed("eye_pass.cl", fault.from, fault.to));
        EXPECT_EQ(bad.non_finite, 16U * fault.counted) << fault.to;
        for (std::size_t i = 0; i < good.points.size(); ++i) {
            const VisiblePoint& point = bad.points[i];
            if (i % 16 != 5) {
                EXPECT_EQ(std::memcmp(&point, &good.points[i], sizeof(point)), 0) << "pixel " << i << ", " << fault.to;
                continue;
            }
            EXPECT_EQ(point.slot != SLOT_NONE, fault.keeps_point) << fault.to;
            EXPECT_EQ(point.direct_x + point.direct_y + point.direct_z, 0.0F) << fault.to;
        }
    }
    const Eye unseen = trace_eye(blind(changed("eye_pass.cl", start, bad_weight)));
    EXPECT_EQ(unseen.non_finite, 0U);
    EXPECT_TRUE(std::isnan(unseen.points[5].direct_x));
}

/// A photon that is not finite, which no photon pass would store, and photons whose sum overflows: only the points near
/// them lose their photons.
TEST_P(NonFinite, GatherLosesOnlyThePointsThatMeetThem) {
    const Device& device = kernel_test::test_device();
    constexpr std::size_t pixels = 16;
    constexpr std::uint32_t photons_each = 3;
    std::vector<VisiblePoint> points(pixels);
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < pixels; ++i) {
        points[i] = {};
        points[i].x = static_cast<float>(i);
        points[i].slot = SLOT_ALL;
        points[i].throughput = 2.0F;
        points[i].radius = 0.1F;
        for (std::uint32_t k = 0; k < photons_each; ++k) {
            Photon photon{};
            photon.x = points[i].x;
            photon.flux_x = photon.flux_y = photon.flux_z = i == 9 ? 2e38F : 1.0F;
            photon.slot = SLOT_ALL;
            photons.push_back(photon);
        }
    }
    photons[3 * 4].flux_y = std::numeric_limits<float>::quiet_NaN();
    PhotonSorter sorter(device, {{"RADIX_BITS", "6"}}, {}, 6);
    sorter.allocate(device, pixels, photons_each);
    using kernel_test::enqueue_in_groups;
    using kernel_test::make_buffer;
    using kernel_test::upload;
    sorter.count(device, upload(std::vector<std::uint32_t>(pixels, photons_each)), enqueue_in_groups);
    const Buffer<SceneConstants> constants = upload(std::vector{SceneConstants{}});
    const Buffer<Photon> photon_buffer = upload(photons);
    const Buffer<std::uint32_t> radius = upload(std::vector{std::bit_cast<std::uint32_t>(0.1F)});
    sorter.sort(constants, photon_buffer, radius, enqueue_in_groups);
    const auto gathered = [&](const std::string& source, std::uint32_t& counted) {
        const ::cl::Program program =
            build_program_from_text(device, "gather.cl", source, {{"RADIX_BITS", "6"}}, {options_.fast_math, {}});
        const Buffer<cl_float4> flux = make_buffer<cl_float4>(pixels);
        const Buffer<std::uint32_t> counts = upload(std::vector<std::uint32_t>(2 * NON_FINITE_COUNTS, 0U));
        kernel_test::run(program, "gather", pixels, constants, upload(std::vector<float>(16, 0.0F)), upload(points),
                         make_buffer<float>(4), photon_buffer, make_buffer<float>(4), sorter.pairs(),
                         sorter.bucket_begin(), radius, 10U, make_buffer<VisibleSurface>(0),
                         make_buffer<PhotonSurface>(0), make_buffer<SurfaceMaterial>(0), make_buffer<SceneFilmLayer>(0),
                         flux, counts);
        const std::vector<cl_float4> result = flux.read(device);
        counted = counts.read(device)[2 * NON_FINITE_GATHER];
        return result;
    };
    std::uint32_t counted = 0;
    const std::vector<cl_float4> flux = gathered(flatten_kernel_source("gather.cl"), counted);
    EXPECT_EQ(counted, 2U);
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_FLOAT_EQ(flux[i].s[c], i == 4 || i == 9 ? 0.0F : 0.6F) << "point " << i;
    }
    const std::vector<cl_float4> unseen = gathered(blind(flatten_kernel_source("gather.cl")), counted);
    EXPECT_EQ(counted, 0U);
    EXPECT_TRUE(std::isnan(unseen[4].s[1]));
}

INSTANTIATE_TEST_SUITE_P(Math, NonFinite, testing::Bool(),
                         [](const auto& fast) { return fast.param ? "fast" : "precise"; });

/// A light whose photons and whose light near by no float can hold: the counts are in the statistics, the EXR file, the
/// warning and the summary, and the image is finite.
TEST(NonFiniteCommand, CountsReachTheUser) {
    const SceneFolder folder;
    const auto scene = [](const std::string& intensity) {
        return "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ]\n"
               "WorldBegin\nLightSource \"point\" \"point3 from\" [ 0 0 4.99 ] \"float scale\" [ " +
               intensity +
               " ]\nMaterial \"diffuse\"\nShape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 "
               "]\n"
               "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 -1  20 -20 -1  -20 20 -1  20 20 -1 ]\n";
    };
    const auto render = [&](const std::string& intensity) {
        const ChildResult result = run_tristim({"render", folder.write("scene.pbrt", scene(intensity)),
                                                "--photons=1024", "--passes=2", "--outfile", folder.path("a.exr"),
                                                "--stats", folder.path("stats.json"), "--initial-radius=0.5"});
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        return result;
    };
    const auto stats = [&] { return nlohmann::json::parse(read_text(folder.path("stats.json"))); };
    const auto in_header = [&] {
        const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(folder.path("a.exr"));
        return input->spec().get_int_attribute("tristim:non_finite_samples", -1);
    };
    const ChildResult good = render("1");
    EXPECT_EQ(stats().at("non_finite"), (nlohmann::json{{"eye", 0}, {"photon", 0}, {"gather", 0}, {"film", 0}}));
    EXPECT_EQ(in_header(), 0);
    EXPECT_NE(good.standard_error.find("; 0 non-finite values;"), std::string::npos) << good.standard_error;
    EXPECT_EQ(good.standard_error.find("warning"), std::string::npos) << good.standard_error;

    const ChildResult bad = render("1e38");
    const nlohmann::json counts = stats().at("non_finite");
    EXPECT_EQ(counts.at("photon"), 2 * 1024);
    EXPECT_GT(counts.at("eye").get<int>(), 0);
    EXPECT_GT(counts.at("film").get<int>(), 0);
    const int total = counts.at("eye").get<int>() + counts.at("photon").get<int>() + counts.at("gather").get<int>() +
                      counts.at("film").get<int>();
    EXPECT_EQ(stats().at("non_finite_samples"), total);
    EXPECT_EQ(in_header(), total);
    EXPECT_NE(bad.standard_error.find("; " + std::to_string(total) + " non-finite values;"), std::string::npos)
        << bad.standard_error;
    EXPECT_NE(
        bad.standard_error.find("warning: " + std::to_string(total) + " values were not finite and left out: eye "),
        std::string::npos)
        << bad.standard_error;
    EXPECT_NO_THROW(read_exr(folder.path("a.exr"))) << "pixels must be finite";
}

} // namespace
} // namespace tristim::test
