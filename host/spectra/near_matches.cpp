#include "spectra/near_matches.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace tristim {

namespace {

/// In lower case and without an end that no name has: comparing two texts takes a time that grows with both.
std::string comparable(std::string text) {
    constexpr std::size_t longest = 100;
    text.resize(std::min(text.size(), longest));
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// Insertions, deletions and replacements that turn one word into the other (Levenshtein 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row[b.size()];
}

} // namespace

std::string near_matches(const std::string& unknown, const std::vector<std::string>& names) {
    const std::string wanted = comparable(unknown);
    std::vector<std::pair<std::size_t, std::string>> ranked;
    for (const std::string& name : names) {
        const std::string candidate = comparable(name);
        const bool contains = !wanted.empty() && candidate.find(wanted) != std::string::npos;
        ranked.emplace_back(contains ? 0 : edit_distance(wanted, candidate), name);
    }
    std::sort(ranked.begin(), ranked.end());
    const std::size_t count = std::min<std::size_t>(ranked.size(), 3);
    std::string text = ranked.at(0).second;
    for (std::size_t i = 1; i < count; ++i)
        text += (i + 1 == count ? " or " : ", ") + ranked[i].second;
    return text;
}

} // namespace tristim
