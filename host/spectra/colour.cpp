#include "spectra/colour.h"

namespace tristim {

namespace {

// IEC 61966-2-1: chromaticities x, y of the red, green and blue primaries and of the white D65.
constexpr std::array<std::array<double, 2>, 3> srgb_primaries{{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}}};
constexpr std::array<double, 2> srgb_white{0.3127, 0.3290};

Xyz xyz_of_chromaticity(const std::array<double, 2>& xy) {
    return {xy[0] / xy[1], 1.0, (1.0 - xy[0] - xy[1]) / xy[1]};
}

std::array<double, 3> multiply(const Matrix3& m, const std::array<double, 3>& v) {
    std::array<double, 3> result{};
    for (std::size_t i = 0; i < 3; ++i)
        result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return result;
}

/// Inverse by cofactors.
Matrix3 inverse(const Matrix3& m) {
    Matrix3 cofactors{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactors[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    }
    const double determinant = m[0][0] * cofactors[0][0] + m[0][1] * cofactors[0][1] + m[0][2] * cofactors[0][2];
    Matrix3 result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            result[i][j] = cofactors[j][i] / determinant;
    }
    return result;
}

} // namespace

const std::array<WavelengthBins, 3>& cie_bins() {
    static const std::array<WavelengthBins, 3> bins{Spectrum::named("cie-x").bins(), Spectrum::named("cie-y").bins(),
                                                    Spectrum::named("cie-z").bins()};
    return bins;
}

double cie_y_integral() {
    static const double integral = [] {
        double sum = 0.0;
        for (const double y : cie_bins()[1])
            sum += y;
        return sum;
    }();
    return integral;
}

Xyz spectrum_to_xyz(const Spectrum& spectrum) {
    const WavelengthBins bins = spectrum.bins();
    Xyz xyz{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t i = 0; i < bins.size(); ++i)
            xyz[channel] += bins[i] * cie_bins()[channel][i];
        xyz[channel] /= cie_y_integral();
    }
    return xyz;
}

Matrix3 rgb_to_xyz_matrix(const Xyz& white) {
    Matrix3 matrix{};
    for (std::size_t j = 0; j < 3; ++j) {
        const Xyz primary = xyz_of_chromaticity(srgb_primaries[j]);
        for (std::size_t i = 0; i < 3; ++i)
            matrix[i][j] = primary[i];
    }
    // Each primary's luminance is such that the three together make the white.
    const std::array<double, 3> luminances = multiply(inverse(matrix), white);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            matrix[i][j] *= luminances[j];
    }
    return matrix;
}

const Matrix3& rgb_to_xyz_matrix() {
    static const Matrix3 matrix = rgb_to_xyz_matrix(xyz_of_chromaticity(srgb_white));
    return matrix;
}

const Matrix3& xyz_to_rgb_matrix() {
    static const Matrix3 matrix = inverse(rgb_to_xyz_matrix());
    return matrix;
}

Rgb xyz_to_rgb(const Xyz& xyz) {
    return multiply(xyz_to_rgb_matrix(), xyz);
}

Xyz rgb_to_xyz(const Rgb& rgb) {
    return multiply(rgb_to_xyz_matrix(), rgb);
}

} // namespace tristim
