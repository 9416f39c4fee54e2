// Files of checkpoints: host/render/checkpoint.h. What is in them comes back to the bit, or not at all.

#include "image/output_file.h"
#include "image/write_image.h"
#include "render/checkpoint.h"
#include "scene_folder.h"

#include <bit>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <random>
#include <sys/file.h>
#include <sys/resource.h>

namespace tristim::test {
namespace {

/// With any bits in every number: values that are not finite, denormal ones, the largest counts.
Checkpoint random_checkpoint(unsigned seed, const Region& region) {
    std::mt19937 random(seed);
    const auto word = [&] { return static_cast<std::uint32_t>(random()); };
    Checkpoint c;
    c.width = 40;
    c.height = 30;
    c.region = region;
    c.sums.film.resize(static_cast<std::size_t>(region.pixels()));
    for (FilmPixel& pixel : c.sums.film) {
        std::array<std::uint32_t, sizeof(FilmPixel) / 4> words{};
        for (std::uint32_t& w : words)
            w = word();
        pixel = std::bit_cast<FilmPixel>(words);
    }
    for (const std::uint32_t bits :
         {0x7f800001U, 0xffc12345U, 0x7f800000U, 0x80000000U, 0x00000001U}) // NaN …, −0, least
        c.sums.film[word() % c.sums.film.size()].sum_low[1] = std::bit_cast<float>(bits);
    c.initial_radii.resize(c.sums.film.size());
    for (float& radius : c.initial_radii)
        radius = std::bit_cast<float>(word() & 0x7fffffU);
    const auto count = [&] { return std::uint64_t{word()} << 32U | word(); };
    c.sums.rays = {count(), count(), count()};
    c.sums.non_finite = {count(), count(), 0, ~std::uint64_t{0}};
    c.sums.photons_stored = count();
    for (std::uint32_t i = 0; i < 400; ++i)
        c.sums.passes.add(PassRanges(7 * i, 7 * i + 1 + i % 5));
    c.identity = {{"method", "hero:4"}, {"seed", "3"}, {"radius", "global"}, {"initial radius", "0.1"}};
    c.scene = "a scene, \"quoted\"\n.pbrt";
    c.devices = "CPU ünïcode";
    c.seconds = 0.1 + 1e6;
    return c;
}

std::string numbers(const Checkpoint& c) {
    const RayTotals& r = c.sums.rays;
    const NonFiniteCounts& n = c.sums.non_finite;
    return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}x{}", r.camera, r.shadow, r.photon, n.eye, n.photon,
                       n.gather, n.film, c.sums.photons_stored, c.seconds, c.scene, c.devices, c.width, c.height);
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same(const Checkpoint& a, const Checkpoint& b) {
    EXPECT_TRUE(same_bytes(a.sums.film, b.sums.film));
    EXPECT_TRUE(same_bytes(a.initial_radii, b.initial_radii));
    EXPECT_EQ(a.sums.passes, b.sums.passes);
    EXPECT_EQ(a.region, b.region);
    EXPECT_EQ(a.identity, b.identity);
    EXPECT_EQ(numbers(a), numbers(b));
}

TEST(Checkpoint, EveryBitComesBack) {
    const SceneFolder folder;
    for (const Region& region : {Region{0, 0, 40, 30}, Region{7, 3, 21, 17}, Region{39, 29, 1, 1}}) {
        const Checkpoint written = random_checkpoint(static_cast<unsigned>(region.x), region);
        const std::string checksum = write_checkpoint(folder.path("a.exr"), written);
        const Checkpoint read = read_checkpoint(folder.path("a.exr"));
        expect_same(read, written);
        EXPECT_EQ(read.checksum, checksum);
        EXPECT_EQ(checksum_in(folder.path("a.exr")), checksum);
    }
    EXPECT_EQ(checksum_in(folder.write("b.exr", "no checkpoint, but as long as a checksum and more than that")), "");
    EXPECT_EQ(checksum_in(folder.path("none.exr")), "");
    Checkpoint without_passes = random_checkpoint(5, {0, 0, 2, 2});
    without_passes.sums.passes = {};
    write_checkpoint(folder.path("a.exr"), without_passes);
    expect_same(read_checkpoint(folder.path("a.exr")), without_passes);
}

TEST(Checkpoint, WhatIsCutShortOrChangedIsRefused) {
    const SceneFolder folder;
    const std::string path = folder.path("a.exr");
    write_checkpoint(path, random_checkpoint(1, {7, 3, 5, 4}));
    const std::string bytes = read_text(path);
    const auto refused = [&](const std::string& damaged) {
        const std::string message = error_of([&] { read_checkpoint(folder.write("b.exr", damaged)); });
        return message.find("damaged") != std::string::npos || message.find("as a checkpoint") != std::string::npos;
    };
    for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 20)
        EXPECT_TRUE(refused(bytes.substr(0, length))) << length;
    EXPECT_TRUE(refused(bytes.substr(0, bytes.size() - 1)));
    EXPECT_TRUE(refused(bytes + "\n"));
    for (std::size_t at = 0; at < bytes.size(); at += 31) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
        EXPECT_TRUE(refused(changed)) << at;
    }
    EXPECT_FALSE(::testing::Test::HasFailure());
    EXPECT_NO_THROW(read_checkpoint(folder.write("b.exr", bytes)));
}

TEST(Checkpoint, OtherFilesAreNamedAsWhatTheyAre) {
    const SceneFolder folder;
    const XyzImage image{2, 1, {0, 0, 2, 1}, {{0.1F, 0.2F, 0.3F}, {0.4F, 0.5F, 0.6F}}};
    write_exr(folder.path("image.exr"), image, ColourSpace::Srgb, {{"passes", std::int64_t{3}}});
    for (const std::string& path : {folder.path("image.exr"), folder.write("empty.exr", "")})
        expect_message(error_of([&] { read_checkpoint(path); }), "cannot use \"" + path + "\" as a checkpoint",
                       "--checkpoint");
    EXPECT_NE(error_of([&] { read_checkpoint(folder.path("none.exr")); }).find("No such file"), std::string::npos);
    EXPECT_NE(error_of([&] { read_checkpoint(folder.path("")); }).find("folder"), std::string::npos);
}

TEST(Checkpoint, WithoutSpaceTheOldOneStays) {
    const SceneFolder folder;
    const std::string path = folder.path("a.exr");
    const Checkpoint old = random_checkpoint(1, {0, 0, 8, 8});
    write_checkpoint(path, old);
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    for (const rlim_t bytes : {0, 1, 1000, 8000}) {
        const rlimit small{bytes, before.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
        EXPECT_NE(error_of([&] {
                      write_checkpoint(path, random_checkpoint(2, {0, 0, 40, 30}));
                  }).find(path),
                  std::string::npos);
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
        expect_same(read_checkpoint(path), old);
    }
    std::signal(SIGXFSZ, handler);
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path("")))
        files += entry.exists() ? 1 : 0;
    EXPECT_EQ(files, 1U) << "temporary files were left";
}

TEST(Checkpoint, LeftoversOfKilledWritersGo) {
    const SceneFolder folder;
    const std::string path = folder.path("a.exr");
    const std::string leftover = folder.write(".a.exr.tmp4711", "half");
    const std::vector<std::string> others{folder.write(".a.exr.tmp", "x"), folder.write(".a.exr.tmp1x", "x"),
                                          folder.write(".b.exr.tmp4711", "x"), folder.write("a.exr", "x")};
    const std::string being_written = folder.write(".a.exr.tmp4712", "half");
    const int writer = ::open(being_written.c_str(), O_WRONLY);
    ASSERT_EQ(::flock(writer, LOCK_EX), 0);
    remove_leftovers(path);
    EXPECT_FALSE(std::filesystem::exists(leftover));
    EXPECT_TRUE(std::filesystem::exists(being_written));
    ::close(writer);
    remove_leftovers(path);
    EXPECT_FALSE(std::filesystem::exists(being_written));
    for (const std::string& other : others)
        EXPECT_TRUE(std::filesystem::exists(other)) << other;
}

Checkpoint part(std::uint32_t begin, std::uint32_t end) {
    Checkpoint c = random_checkpoint(1, {0, 0, 4, 3});
    c.sums.film.assign(12, {});
    for (FilmPixel& pixel : c.sums.film) {
        pixel.sum_high[1] = static_cast<float>(end - begin);
        pixel.samples = end - begin;
    }
    c.sums.passes = PassRanges(begin, end);
    c.sums.rays = {1, 2, end};
    c.sums.photons_stored = end;
    return c;
}

TEST(Checkpoint, DisjointRangesAddUp) {
    Checkpoint sum = part(10, 20);
    add_checkpoint(sum, "a", part(0, 4), "b", false);
    add_checkpoint(sum, "a", part(4, 10), "c", false);
    EXPECT_EQ(sum.sums.passes.text(), "0:20");
    EXPECT_TRUE(holds_passes(sum.sums.film, 20));
    EXPECT_EQ(sample_sums(sum.sums.film[5])[1], 20.0);
    EXPECT_EQ(sum.sums.rays.photon, 34U);
    EXPECT_EQ(sum.sums.photons_stored, 34U);
}

TEST(Checkpoint, WhatDoesNotAddUpIsRefusedByName) {
    const Checkpoint a = part(0, 10);
    const auto refusal = [&](Checkpoint b) {
        Checkpoint sum = a;
        const std::string message = error_of([&] { add_checkpoint(sum, "a.exr", b, "b.exr", false); });
        expect_same(sum, a);
        EXPECT_EQ(message.rfind("cannot merge \"b.exr\" with \"a.exr\": ", 0), 0U) << message;
        return message;
    };
    EXPECT_NE(refusal(part(9, 12)).find("both hold the passes 9:10"), std::string::npos);
    Checkpoint other = part(10, 12);
    other.identity[0].second = "tristimulus:1";
    other.identity[1].second = "4";
    const std::string both = refusal(other);
    EXPECT_NE(both.find("with method tristimulus:1, not hero:4"), std::string::npos) << both;
    EXPECT_NE(both.find("with seed 4, not 3"), std::string::npos) << both;
    other = part(10, 12);
    other.initial_radii[3] += 1e-3F;
    EXPECT_NE(refusal(other).find("--any-radii"), std::string::npos);
    Checkpoint sum = a;
    add_checkpoint(sum, "a.exr", other, "b.exr", true);
    EXPECT_EQ(sum.sums.passes.text(), "0:12");
    EXPECT_TRUE(same_bytes(sum.initial_radii, a.initial_radii));

    Checkpoint first = a, second = part(10, 12);
    first.identity[2].second = second.identity[2].second = "statistics";
    EXPECT_NE(error_of([&] { add_checkpoint(first, "a", second, "b", false); }).find("--radius statistics"),
              std::string::npos);
}

} // namespace
} // namespace tristim::test
