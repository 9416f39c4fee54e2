// Spectra of RGB colours by W. Jakob & J. Hanika, "A low-dimensional function space for efficient spectral upsampling",
// Computer Graphics Forum 38(2), 2019. A reflectance is s(x(λ)), s(x) = 1/2 + x / (2 √(1 + x²)),
// x a quadratic polynomial of the wavelength. Its coefficients are found per colour, in double precision, such that the
// reflectance under D65 has the colour's CIELAB values.
#include "spectra/rgb_upsampling.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tristim {

namespace {

using Vector3 = std::array<double, 3>;

constexpr int first_nm = 360;
constexpr int last_nm = 830;

double sigmoid(double x) {
    return 0.5 + 0.5 * x / std::sqrt(1.0 + x * x);
}

double sigmoid_slope(double x) {
    const double square = 1.0 + x * x;
    return 0.5 / (square * std::sqrt(square));
}

/// The polynomial's variable: the wavelength mapped to [−1, 1], so that the three coefficients are of one size.
double variable(double lambda_nm) {
    return (2.0 * lambda_nm - (first_nm + last_nm)) / (last_nm - first_nm);
}

double polynomial(const Vector3& c, double lambda_nm) {
    const double t = variable(lambda_nm);
    return (c[0] * t + c[1]) * t + c[2];
}

/// f of CIELAB (CIE 15:2018, section 8.2.1) and its slope.
Vector3 cube_root_or_line(const Vector3& ratio) {
    Vector3 f{};
    for (std::size_t i = 0; i < 3; ++i)
        f[i] = ratio[i] > 216.0 / 24389.0 ? std::cbrt(ratio[i]) : ratio[i] * 841.0 / 108.0 + 4.0 / 29.0;
    return f;
}

double cube_root_or_line_slope(double ratio) {
    return ratio > 216.0 / 24389.0 ? 1.0 / (3.0 * std::cbrt(ratio * ratio)) : 841.0 / 108.0;
}

Vector3 to_lab(const Vector3& f) {
    return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

double length(const Vector3& v) {
    return std::hypot(v[0], v[1], v[2]);
}

/// Solves m x = b by Cramer's rule.
Vector3 solve(const Matrix3& m, const Vector3& b) {
    const auto determinant = [](const Matrix3& a) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    const double denominator = determinant(m);
    Vector3 x{};
    for (std::size_t j = 0; j < 3; ++j) {
        Matrix3 replaced = m;
        for (std::size_t i = 0; i < 3; ++i)
            replaced[i][j] = b[i];
        x[j] = determinant(replaced) / denominator;
    }
    return x;
}

/// The fit of reflectances to colours under D65.
class ReflectanceFit {
  public:
    /// The coefficients for a colour in [0, 1]³ that is not grey; those of the nearest colour on the way from grey that
    /// the solver reached, should it fail to reach the colour itself.
    Vector3 coefficients(const Rgb& rgb) const {
        // Start from the grey of the same luminance, which is solved in closed form, and move towards the colour in
        // steps as large as the solver can follow.
        const double grey = multiply_row(1, rgb) / white_[1];
        // Beside black and white the grey may round to 0 or 1, where the sigmoid's argument is infinite.
        const double u = std::clamp(2.0 * grey - 1.0, -1.0 + 1e-15, 1.0 - 1e-15);
        Vector3 c{0.0, 0.0, u / std::sqrt(1.0 - u * u)};
        double reached = 0.0;
        double step = 1.0;
        while (reached < 1.0 && step > smallest_step) {
            const double next = std::min(1.0, reached + step);
            Rgb target{};
            for (std::size_t i = 0; i < 3; ++i)
                target[i] = grey + next * (rgb[i] - grey);
            Vector3 trial = c;
            if (refine(trial, lab_of_rgb(target))) {
                c = trial;
                reached = next;
                step *= 2.0;
            } else {
                step *= 0.5;
            }
        }
        return c;
    }

  private:
    static constexpr double tolerance = 1e-6; // CIELAB units; a just noticeable difference is about 1
    static constexpr double smallest_step = 1e-4;

    double multiply_row(std::size_t row, const Rgb& rgb) const {
        return rgb_to_xyz_[row][0] * rgb[0] + rgb_to_xyz_[row][1] * rgb[1] + rgb_to_xyz_[row][2] * rgb[2];
    }

    Vector3 lab_of_rgb(const Rgb& rgb) const {
        Vector3 ratio{};
        for (std::size_t i = 0; i < 3; ++i)
            ratio[i] = multiply_row(i, rgb) / white_[i];
        return to_lab(cube_root_or_line(ratio));
    }

    /// CIELAB of the reflectance with coefficients c under D65, and its derivatives by c.
    Vector3 lab_of_coefficients(const Vector3& c, Matrix3& jacobian) const {
        Vector3 ratio{};
        Matrix3 slopes{};
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            const double lambda = lambda_min_nm + static_cast<double>(i);
            const double t = variable(lambda);
            const double x = polynomial(c, lambda);
            const double s = sigmoid(x);
            const double ds = sigmoid_slope(x);
            const Vector3 powers{t * t, t, 1.0};
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double weight = weights_[i][channel] / white_[channel];
                ratio[channel] += weight * s;
                for (std::size_t j = 0; j < 3; ++j)
                    slopes[channel][j] += weight * ds * powers[j];
            }
        }
        for (std::size_t j = 0; j < 3; ++j) {
            Vector3 df{};
            for (std::size_t channel = 0; channel < 3; ++channel)
                df[channel] = cube_root_or_line_slope(ratio[channel]) * slopes[channel][j];
            jacobian[0][j] = 116.0 * df[1];
            jacobian[1][j] = 500.0 * (df[0] - df[1]);
            jacobian[2][j] = 200.0 * (df[1] - df[2]);
        }
        return to_lab(cube_root_or_line(ratio));
    }

    /// Gauss–Newton steps, damped as by Levenberg (1944) and Marquardt (1963), from c to the target. True if reached.
    bool refine(Vector3& c, const Vector3& target) const {
        double damping = 0.0;
        Matrix3 jacobian{};
        const auto evaluate = [&](const Vector3& at, Matrix3& derivatives) {
            const Vector3 lab = lab_of_coefficients(at, derivatives);
            return Vector3{lab[0] - target[0], lab[1] - target[1], lab[2] - target[2]};
        };
        Vector3 residual = evaluate(c, jacobian);
        double error = length(residual);
        for (int iteration = 0; iteration < 60 && error > tolerance; ++iteration) {
            Matrix3 normal{};
            Vector3 gradient{};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) {
                    for (std::size_t k = 0; k < 3; ++k)
                        normal[i][j] += jacobian[k][i] * jacobian[k][j];
                    gradient[i] += jacobian[j][i] * residual[j];
                }
            }
            Matrix3 damped = normal;
            for (std::size_t i = 0; i < 3; ++i)
                damped[i][i] *= 1.0 + damping;
            const Vector3 change = damping > 0.0 ? solve(damped, gradient) : solve(jacobian, residual);
            const Vector3 trial{c[0] - change[0], c[1] - change[1], c[2] - change[2]};
            Matrix3 trial_jacobian{};
            const Vector3 trial_residual = evaluate(trial, trial_jacobian);
            const double trial_error = length(trial_residual);
            if (trial_error < error) {
                c = trial;
                residual = trial_residual;
                jacobian = trial_jacobian;
                error = trial_error;
                damping = damping > 1e-9 ? damping * 0.1 : 0.0;
            } else {
                damping = std::max(damping * 10.0, 1e-6);
            }
        }
        return error <= tolerance;
    }

    const std::array<Xyz, lambda_bins + 1>& weights_ = d65_colour().weights;
    const Xyz& white_ = d65_colour().white;
    const Matrix3& rgb_to_xyz_ = d65_colour().rgb_to_xyz;
};

} // namespace

Spectrum jakob_hanika_reflectance(const Rgb& rgb) {
    static const ReflectanceFit fit;
    const Vector3 c = fit.coefficients(rgb);
    std::vector<double> lambda_nm;
    std::vector<double> values;
    for (int lambda = first_nm; lambda <= last_nm; ++lambda) {
        lambda_nm.push_back(lambda);
        values.push_back(sigmoid(polynomial(c, lambda)));
    }
    return Spectrum::piecewise_linear(std::move(lambda_nm), std::move(values));
}

} // namespace tristim
