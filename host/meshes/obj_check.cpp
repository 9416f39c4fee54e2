#include "meshes/mesh_checks.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace tristim {

namespace {

constexpr std::string_view blanks = " \t\r";

/// Takes the first word off the front of a line; empty at its end.
std::string_view take_word(std::string_view& line) {
    const std::size_t begin = std::min(line.find_first_not_of(blanks), line.size());
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

template <typename Number>
std::optional<Number> parse(std::string_view word) {
    if (word.size() > 1 && word.front() == '+')
        word.remove_prefix(1);
    Number value{};
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size())
        return std::nullopt;
    return value;
}

struct Position {
    const std::string& path;
    std::size_t line;
};

/// Leaves what follows the numbers in `line`.
void check_numbers(const Position& at, std::string_view keyword, std::string_view& line) {
    const int count = keyword == "vt" ? 2 : 3;
    for (int i = 0; i < count; ++i) {
        const std::string_view word = take_word(line);
        const auto value = parse<float>(word);
        if (!value || !std::isfinite(*value))
            fail("{}:{}: \"{}\" in \"{}\" is not a finite number", at.path, at.line, word, keyword);
    }
}

/// A 1-based or, counted from the end of the `current` entries so far, negative index into `total` entries.
void check_index(const Position& at, std::string_view word, std::size_t current, std::size_t total,
                 std::string_view what) {
    const auto value = parse<long long>(word);
    if (!value)
        fail("{}:{}: \"{}\" in \"f\" is not an index", at.path, at.line, word);
    const long long index = *value < 0 ? static_cast<long long>(current) + *value + 1 : *value;
    if (index < 1 || index > static_cast<long long>(total))
        fail("{}:{}: the {} index {} is out of range: the file has {}", at.path, at.line, what, *value, total);
}

struct Totals {
    std::size_t v = 0, vt = 0, vn = 0;
};

void check_face(const Position& at, std::string_view line, const Totals& current, const Totals& totals) {
    int corners = 0;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++corners) {
        const std::size_t slash = std::min(word.find('/'), word.size());
        check_index(at, word.substr(0, slash), current.v, totals.v, "vertex");
        if (slash == word.size())
            continue;
        const std::string_view rest = word.substr(slash + 1);
        const std::size_t second = std::min(rest.find('/'), rest.size());
        if (second > 0)
            check_index(at, rest.substr(0, second), current.vt, totals.vt, "texture coordinate");
        if (second < rest.size())
            check_index(at, rest.substr(second + 1), current.vn, totals.vn, "normal");
    }
    if (corners < 3)
        fail("{}:{}: a face has {} corners, but it needs three", at.path, at.line, corners);
}

template <typename Visitor>
void for_each_line(std::string_view text, Visitor visit) {
    std::size_t number = 1;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        const std::string_view keyword = take_word(line);
        visit(number, keyword, line);
        text.remove_prefix(std::min(end + 1, text.size()));
        ++number;
    }
}

void count(Totals& totals, std::string_view keyword) {
    totals.v += keyword == "v";
    totals.vt += keyword == "vt";
    totals.vn += keyword == "vn";
}

} // namespace

ObjCounts check_obj(const std::string& path, std::string_view text) {
    Totals totals;
    for_each_line(text, [&](std::size_t, std::string_view keyword, std::string_view) { count(totals, keyword); });

    Totals current;
    ObjCounts counts;
    for_each_line(text, [&](std::size_t number, std::string_view keyword, std::string_view line) {
        const Position at{path, number};
        count(current, keyword);
        if (!keyword.empty() && line.ends_with('\\') && keyword.front() != '#')
            fail("{}:{}: a line that goes on after \"\\\" is not supported", path, number);
        if (keyword == "v" || keyword == "vt" || keyword == "vn") {
            check_numbers(at, keyword, line);
            counts.has_w |= keyword == "vt" && !take_word(line).empty();
        } else if (keyword == "f") {
            check_face(at, line, current, totals);
            ++counts.faces;
        }
    });
    counts.vertices = totals.v;
    return counts;
}

std::string without_w(std::string text) {
    std::vector<std::string_view> surplus;
    for_each_line(text, [&](std::size_t, std::string_view keyword, std::string_view line) {
        if (keyword != "vt")
            return;
        take_word(line);
        take_word(line);
        surplus.push_back(line);
    });
    for (const std::string_view part : surplus)
        std::fill_n(text.begin() + (part.data() - text.data()), part.size(), ' ');
    return text;
}

} // namespace tristim
