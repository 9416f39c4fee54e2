#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tristim {

/// Numbers of passes: a set, kept as ranges that neither overlap nor touch, ascending. Numbers lie below pilot_pass.
class PassRanges {
  public:
    /// The passes begin, …, end − 1.
    struct Range {
        std::uint32_t begin = 0;
        std::uint32_t end = 0;
        bool operator==(const Range&) const = default;
    };

    PassRanges() = default;

    /// One range; none of its passes if it is empty.
    PassRanges(std::uint32_t begin, std::uint32_t end);

    /// Of single passes in any order. Throws Error if one comes twice.
    static PassRanges of(std::vector<std::uint32_t> passes);

    /// Add what is not in it yet; throw Error, and leave it as it was, if any of it is.
    void add(std::uint32_t pass) { add(PassRanges(pass, pass + 1)); }
    void add(const PassRanges& more);

    /// The passes in both.
    PassRanges common(const PassRanges& other) const;

    /// Its passes that are not in the other.
    PassRanges without(const PassRanges& other) const;

    /// Takes the first of its passes away, so many or all that there are, and returns them.
    PassRanges take(std::uint64_t count);

    /// The passes from begin to end − 1 that are not in it.
    PassRanges missing(std::uint32_t begin, std::uint32_t end) const;

    bool empty() const { return ranges_.empty(); }
    std::uint64_t count() const;
    const std::vector<Range>& ranges() const { return ranges_; }
    bool operator==(const PassRanges&) const = default;

    /// "0:100,120:130", without the ends; "" if it is empty.
    std::string text() const;

    /// From such a text, ranges in any order. Throws Error if it is none, a range is empty or two of them overlap.
    static PassRanges parse(std::string_view text);

  private:
    std::vector<Range> ranges_;
};

} // namespace tristim
