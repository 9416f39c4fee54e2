#include "line_mutator.h"

#include <algorithm>
#include <array>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace tristim::fuzz {

namespace {

using Random = std::minstd_rand;

/// Zero, signs, the ends of float, double and the integer types, numbers that overflow when multiplied or squared, and
/// what other programs write where there is no number.
constexpr std::array<std::string_view, 32> numbers{
    "0",          "-0",         "1",     "-1",    "2",      "3",      "0.5",        "255",          "256",
    "65535",      "65536",      "1e-7",  "1e7",   "1e-19",  "1e19",   "1e-38",      "3.4028235e38", "3.5e38",
    "1e-45",      "1e-300",     "1e300", "1e308", "-1e308", "5e-324", "2147483647", "2147483648",   "-2147483648",
    "4294967295", "4294967296", "1e999", "nan",   "inf"};

std::size_t below(Random& random, std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

/// Where the words of a text begin and end; brackets and quotes are not part of them.
std::vector<std::pair<std::size_t, std::size_t>> words_of(const std::string& text) {
    constexpr std::string_view gaps = " \t\r\n[]\",|:";
    std::vector<std::pair<std::size_t, std::size_t>> words;
    for (std::size_t begin = text.find_first_not_of(gaps); begin != text.npos;) {
        const std::size_t end = std::min(text.find_first_of(gaps, begin), text.size());
        words.emplace_back(begin, end);
        begin = text.find_first_not_of(gaps, end);
    }
    return words;
}

bool is_number(std::string_view word) {
    return word.find_first_of("0123456789") != word.npos && word.find_first_not_of("0123456789+-.eE") == word.npos;
}

void change_lines(std::string& text, Random& random) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
        lines.push_back(text.substr(begin, end - begin));
        begin = end;
    }
    if (lines.empty())
        return;
    const std::size_t line = below(random, lines.size());
    const auto at = lines.begin() + static_cast<std::ptrdiff_t>(line);
    switch (below(random, 3)) {
    case 0:
        lines.insert(at, std::string(*at));
        break;
    case 1:
        lines.erase(at);
        break;
    default:
        std::swap(*at, lines[below(random, lines.size())]);
    }
    text.clear();
    for (const std::string& each : lines)
        text += each;
}

void change_word(std::string& text, Random& random) {
    auto words = words_of(text);
    if (words.empty())
        return;
    const auto [from_begin, from_end] = words[below(random, words.size())];
    std::string replacement = text.substr(from_begin, from_end - from_begin);
    const bool to_extreme = below(random, 2) == 0;
    if (to_extreme) {
        replacement = numbers[below(random, numbers.size())];
        std::erase_if(words, [&](const auto& word) {
            return !is_number(std::string_view(text).substr(word.first, word.second - word.first));
        });
    }
    if (words.empty())
        return;
    const auto [begin, end] = words[below(random, words.size())];
    text.replace(begin, end - begin, replacement);
}

} // namespace

std::string mutate_lines(const std::string& text, unsigned seed) {
    Random random(seed);
    std::string result = text;
    for (std::size_t changes = 1 + below(random, 3); changes > 0; --changes) {
        if (below(random, 3) == 0)
            change_lines(result, random);
        else
            change_word(result, random);
    }
    return result;
}

std::size_t mutate_text(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
    if (seed % 2 == 0)
        return LLVMFuzzerMutate(data, size, max_size);
    const std::string result = mutate_lines(std::string(data, data + size), seed / 2);
    if (result.empty() || result.size() > max_size)
        return LLVMFuzzerMutate(data, size, max_size);
    std::copy(result.begin(), result.end(), data);
    return result.size();
}

} // namespace tristim::fuzz
