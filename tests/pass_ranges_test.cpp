// Sets of passes: host/render/pass_ranges.h, against std::set.

#include "render/pass_ranges.h"
#include "scene_folder.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace tristim::test {
namespace {

using Set = std::set<std::uint32_t>;

Set passes_of(const PassRanges& passes) {
    Set result;
    for (const PassRanges::Range& range : passes.ranges()) {
        for (std::uint32_t pass = range.begin; pass < range.end; ++pass)
            result.insert(pass);
    }
    return result;
}

void expect_minimal(const PassRanges& passes) {
    for (std::size_t i = 0; i < passes.ranges().size(); ++i) {
        EXPECT_LT(passes.ranges()[i].begin, passes.ranges()[i].end);
        EXPECT_TRUE(i == 0 || passes.ranges()[i - 1].end < passes.ranges()[i].begin);
    }
}

TEST(PassRanges, AreTheSetsThatTheySay) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<std::uint32_t> numbers(40);
        for (std::uint32_t i = 0; i < 40; ++i)
            numbers[i] = i;
        std::shuffle(numbers.begin(), numbers.end(), random);
        const std::size_t in_a = random() % 41, in_b = random() % (41 - in_a);
        const auto first = numbers.begin(), second = first + static_cast<std::ptrdiff_t>(in_a);
        const std::vector<std::uint32_t> of_a(first, second), of_b(second, second + static_cast<std::ptrdiff_t>(in_b));
        const Set set_a(of_a.begin(), of_a.end()), set_b(of_b.begin(), of_b.end());
        PassRanges a;
        for (const std::uint32_t pass : of_a)
            a.add(pass);
        const PassRanges b = PassRanges::of(of_b);
        expect_minimal(a);
        EXPECT_EQ(a, PassRanges::of(of_a));
        EXPECT_EQ(passes_of(a), set_a);
        EXPECT_EQ(a.count(), set_a.size());
        EXPECT_EQ(passes_of(b), set_b);
        EXPECT_TRUE(a.common(b).empty());
        PassRanges both = a;
        both.add(b);
        expect_minimal(both);
        Set set_both = set_a;
        set_both.insert(set_b.begin(), set_b.end());
        EXPECT_EQ(passes_of(both), set_both);
        EXPECT_EQ(both.common(a), a);
        EXPECT_EQ(b.common(both), b);
        const auto begin = static_cast<std::uint32_t>(random() % 40), end = static_cast<std::uint32_t>(random() % 50);
        Set missing;
        for (std::uint32_t pass = begin; pass < end; ++pass) {
            if (!set_both.contains(pass))
                missing.insert(pass);
        }
        EXPECT_EQ(passes_of(both.missing(begin, end)), missing);
        expect_minimal(both.missing(begin, end));
        EXPECT_TRUE(both.empty() || PassRanges::parse(both.text()) == both);
    }
}

TEST(PassRanges, NothingIsAddedTwice) {
    PassRanges passes = PassRanges::parse("120:130,0:100");
    EXPECT_EQ(passes.text(), "0:100,120:130");
    EXPECT_EQ(passes.count(), 110U);
    const PassRanges before = passes;
    EXPECT_NE(error_of([&] { passes.add(PassRanges::parse("90:125")); }).find("90:100,120:125"), std::string::npos);
    EXPECT_NE(error_of([&] { passes.add(129); }).find("129:130"), std::string::npos);
    EXPECT_EQ(passes, before);
    passes.add(PassRanges(100, 120));
    EXPECT_EQ(passes.text(), "0:130");
    passes.add(PassRanges(4294967294U, 4294967295U));
    EXPECT_EQ(passes.missing(0, 4294967295U).text(), "130:4294967294");
}

TEST(PassRanges, WhatIsNoRangeIsRefused) {
    for (const char* text :
         {"", "5", "5:", ":5", "5:5", "6:5", "-1:5", "1:4294967296", "1:2:3", "1:2,", "a:b", " 1:2", "1:3,2:4"})
        EXPECT_NE(error_of([&] { PassRanges::parse(text); }), "") << text;
}

} // namespace
} // namespace tristim::test
