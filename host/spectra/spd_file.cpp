#include "spectra/spd_file.h"

#include "base/error.h"
#include "base/read_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>
#include <vector>

namespace tristim {

namespace {

double parse_column(std::string_view word, const std::string& name, int line) {
    // std::from_chars knows no leading '+', which other programs write.
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double number = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(number))
        fail("{}:{}: \"{}\" is not a finite number", name, line, word);
    // The kernels' tables are in single precision.
    if (std::abs(number) > std::numeric_limits<float>::max())
        fail("{}:{}: \"{}\" is too large for a finite number in single precision", name, line, word);
    return number;
}

} // namespace

Spectrum parse_spd(std::string_view text, const std::string& name) {
    std::vector<double> lambda_nm;
    std::vector<double> values;
    bool pair_is_open = false;
    int number_line = 1;
    for (int line = 1; !text.empty(); ++line) {
        const std::size_t line_end = std::min(text.find('\n'), text.size());
        std::string_view rest = text.substr(0, line_end);
        text.remove_prefix(std::min(line_end + 1, text.size()));
        rest = rest.substr(0, rest.find('#'));
        constexpr std::string_view white_space = " \t\r\f\v";
        for (auto begin = rest.find_first_not_of(white_space); begin != rest.npos;
             begin = rest.find_first_not_of(white_space)) {
            rest.remove_prefix(begin);
            const std::string_view word = rest.substr(0, rest.find_first_of(white_space));
            rest.remove_prefix(word.size());
            const double number = parse_column(word, name, line);
            if (!pair_is_open && !lambda_nm.empty() && number <= lambda_nm.back())
                fail("{}:{}: the wavelengths do not ascend: {} nm follows {} nm", name, line, number, lambda_nm.back());
            (pair_is_open ? values : lambda_nm).push_back(number);
            pair_is_open = !pair_is_open;
            number_line = line;
        }
    }
    if (pair_is_open)
        fail("{}:{}: the wavelength {} nm has no value", name, number_line, lambda_nm.back());
    if (values.empty())
        fail("{}:{}: the file holds no samples", name, number_line);
    return Spectrum::piecewise_linear(std::move(lambda_nm), std::move(values));
}

Spectrum Spectrum::read_spd(const std::string& path) {
    refuse_device(path);
    std::ifstream file(path, std::ios::binary);
    std::string text;
    std::array<char, 65536> block;
    while (file.read(block.data(), block.size()), file.gcount() > 0)
        text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    // A folder can be opened; only reading it fails.
    if (!file.is_open() || file.bad())
        fail("cannot read the spectrum file {}: {}", path, std::strerror(errno));
    return parse_spd(text, path);
}

} // namespace tristim
