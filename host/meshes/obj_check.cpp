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

/// Adds the numbers of a line that count to `text`.
void check_numbers(const Position& at, std::string_view keyword, std::string_view line, std::string& text) {
    const int count = keyword == "vt" ? 2 : 3;
    for (int i = 0; i < count; ++i) {
        const std::string_view word = take_word(line);
        // Read in double precision, numbers that are 0 in float are no error.
        const auto value = parse<double>(word);
        if (!value || !std::isfinite(static_cast<float>(*value)))
            fail("{}:{}: \"{}\" in \"{}\" is not a finite number", at.path, at.line, word, keyword);
        text.append(" ").append(word);
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

/// Adds the corners of a face to `text`.
void check_face(const Position& at, std::string_view line, const Totals& current, const Totals& totals,
                std::string& text) {
    int corners = 0;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++corners) {
        text.append(" ").append(word);
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
    if (static_cast<std::size_t>(corners) > max_face_corners)
        fail("{}:{}: a face has {} corners, and more than {} are not supported", at.path, at.line, corners,
             max_face_corners);
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

CheckedObj check_obj(const std::string& path, std::string_view text) {
    Totals totals;
    for_each_line(text, [&](std::size_t, std::string_view keyword, std::string_view) { count(totals, keyword); });

    Totals current;
    CheckedObj result;
    for_each_line(text, [&](std::size_t number, std::string_view keyword, std::string_view line) {
        const Position at{path, number};
        count(current, keyword);
        if (!keyword.empty() && line.ends_with('\\') && keyword.front() != '#')
            fail("{}:{}: a line that goes on after \"\\\" is not supported", path, number);
        const bool has_numbers = keyword == "v" || keyword == "vt" || keyword == "vn";
        if (!has_numbers && keyword != "f")
            return;
        result.text += keyword;
        if (has_numbers) {
            check_numbers(at, keyword, line, result.text);
        } else {
            check_face(at, line, current, totals, result.text);
            ++result.faces;
        }
        result.text += '\n';
    });
    result.vertices = totals.v;
    return result;
}

} // namespace tristim
