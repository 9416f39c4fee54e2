#include "render/pass_ranges.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "base/split.h"

#include <algorithm>

namespace tristim {

PassRanges::PassRanges(std::uint32_t begin, std::uint32_t end) {
    if (begin < end)
        ranges_.push_back({begin, end});
}

PassRanges PassRanges::of(std::vector<std::uint32_t> passes) {
    std::sort(passes.begin(), passes.end());
    PassRanges result;
    for (const std::uint32_t pass : passes)
        result.add(pass);
    return result;
}

void PassRanges::add(const PassRanges& more) {
    if (more.ranges_.size() == 1 && !ranges_.empty() && ranges_.back().end == more.ranges_.front().begin) {
        ranges_.back().end = more.ranges_.front().end;
        return;
    }
    if (more.empty())
        return;
    if (ranges_.empty() || ranges_.back().end < more.ranges_.front().begin) {
        ranges_.insert(ranges_.end(), more.ranges_.begin(), more.ranges_.end());
        return;
    }
    if (const PassRanges twice = common(more); !twice.empty())
        fail("passes {} would be added a second time", twice.text());
    std::vector<Range> all = ranges_;
    all.insert(all.end(), more.ranges_.begin(), more.ranges_.end());
    std::sort(all.begin(), all.end(), [](const Range& a, const Range& b) { return a.begin < b.begin; });
    ranges_.clear();
    for (const Range& range : all) {
        if (!ranges_.empty() && ranges_.back().end == range.begin)
            ranges_.back().end = range.end;
        else
            ranges_.push_back(range);
    }
}

PassRanges PassRanges::common(const PassRanges& other) const {
    PassRanges result;
    auto a = ranges_.begin(), b = other.ranges_.begin();
    while (a != ranges_.end() && b != other.ranges_.end()) {
        const std::uint32_t begin = std::max(a->begin, b->begin), end = std::min(a->end, b->end);
        if (begin < end)
            result.ranges_.push_back({begin, end});
        if (a->end < b->end)
            ++a;
        else
            ++b;
    }
    return result;
}

PassRanges PassRanges::without(const PassRanges& other) const {
    PassRanges result;
    auto b = other.ranges_.begin();
    for (Range rest : ranges_) {
        while (b != other.ranges_.end() && b->begin < rest.end) {
            if (rest.begin < b->begin)
                result.ranges_.push_back({rest.begin, b->begin});
            rest.begin = std::max(rest.begin, b->end);
            if (b->end > rest.end)
                break;
            ++b;
        }
        if (rest.begin < rest.end)
            result.ranges_.push_back(rest);
    }
    return result;
}

PassRanges PassRanges::take(std::uint64_t count) {
    PassRanges taken;
    auto range = ranges_.begin();
    for (; range != ranges_.end() && count > 0; ++range) {
        const auto part = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, range->end - range->begin));
        taken.ranges_.push_back({range->begin, range->begin + part});
        range->begin += part;
        count -= part;
        if (range->begin < range->end)
            break;
    }
    ranges_.erase(ranges_.begin(), range);
    return taken;
}

PassRanges PassRanges::missing(std::uint32_t begin, std::uint32_t end) const {
    PassRanges result;
    for (const Range& range : ranges_) {
        if (begin < std::min(range.begin, end))
            result.ranges_.push_back({begin, std::min(range.begin, end)});
        begin = std::max(begin, range.end);
    }
    if (begin < end)
        result.ranges_.push_back({begin, end});
    return result;
}

std::uint64_t PassRanges::count() const {
    std::uint64_t sum = 0;
    for (const Range& range : ranges_)
        sum += range.end - range.begin;
    return sum;
}

std::string PassRanges::text() const {
    std::string text;
    for (const Range& range : ranges_)
        text += fmt::format("{}{}:{}", text.empty() ? "" : ",", range.begin, range.end);
    return text;
}

PassRanges PassRanges::parse(std::string_view text) {
    PassRanges result;
    for (const std::string& part : split(std::string(text), ',')) {
        const std::size_t colon = part.find(':');
        const auto begin = parse_number<std::uint32_t>(std::string_view(part).substr(0, colon));
        const auto end = parse_number<std::uint32_t>(
            colon == std::string::npos ? std::string_view() : std::string_view(part).substr(colon + 1));
        if (!begin || !end || *begin >= *end)
            fail("bad range of passes '{}': expected A:B, the passes from A to B - 1, with whole numbers 0 <= A < B < "
                 "4294967296",
                 part);
        result.add(PassRanges(*begin, *end));
    }
    return result;
}

} // namespace tristim
