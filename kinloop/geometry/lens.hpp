#pragma once
// In: ideal image coordinates x/z, y/z of a pinhole. Out: those where a real lens images the same ray, and
// back.

#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/core/options.hpp"

namespace kinloop {

enum class LensModel {
  kBrownConrady,   ///< Brown 1966; k1 k2 p1 p2 k3. No distortion if all are zero.
  kRational,       ///< OpenCV's CALIB_RATIONAL_MODEL; the same and k4 k5 k6 in the denominator
  kKannalaBrandt,  ///< Kannala and Brandt 2006, OpenCV's fisheye; k1 k2 k3 k4, powers of the angle to the
                   ///< axis
};

constexpr auto option_names(LensModel) {
  return std::to_array<EnumName<LensModel>>({{LensModel::kBrownConrady, "brown_conrady"},
                                             {LensModel::kRational, "rational"},
                                             {LensModel::kKannalaBrandt, "kannala_brandt"}});
}

/// Distortion of a lens; coefficients that the model does not have are zero.
///
/// Every model has a limit of its field of view: the radius beyond which the polynomial turns back, at most
/// `kMaxRadius`. Only within it do ideal and distorted coordinates correspond.
struct LensDistortion {
  static constexpr double kMaxRadius = 100;  ///< 89.4 degrees from the axis

  LensModel model = LensModel::kBrownConrady;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;

  bool operator==(const LensDistortion&) const = default;

  /// Returns whether `distort` changes nothing. A fisheye lens always distorts.
  [[nodiscard]] bool is_identity() const;

  /// Returns the distorted coordinates of ideal ones.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& ideal) const;

  /// Returns the 2x2 Jacobian of `distort`.
  [[nodiscard]] Eigen::Matrix2d distort_jacobian(const Eigen::Vector2d& ideal) const;

  /// Returns the ideal coordinates of distorted ones (Newton's method). Coordinates that the lens cannot
  /// produce give the limit of the field of view in their direction.
  [[nodiscard]] Eigen::Vector2d undistort(const Eigen::Vector2d& distorted) const;
};

/// Returns the coefficients in OpenCV's order: k1 k2 p1 p2 k3, then k4 k5 k6 of the rational model; k1 k2 k3
/// k4 of Kannala and Brandt.
std::vector<double> lens_coefficients(const LensDistortion& lens);

/// Returns the lens with these coefficients; there must be 5, 8 or 4 of them.
LensDistortion lens_with(LensModel model, std::span<const double> coefficients);

/// For given denominators, distortion is linear: distorted = constant + basis * (k1, k2, p1, p2, k3), for
/// Kannala and Brandt (k1, k2, k3, k4, unused).
struct LinearDistortion {
  static constexpr int kTerms = 5;
  Eigen::Vector2d constant;
  Eigen::Matrix<double, kTerms, 1> along_x, along_y;  ///< rows of the basis
};
LinearDistortion linear_distortion(const LensDistortion& lens, const Eigen::Vector2d& ideal);

/// Replaces the linear coefficients.
void set_linear_coefficients(LensDistortion& lens,
                             const Eigen::Matrix<double, LinearDistortion::kTerms, 1>& coefficients);

}  // namespace kinloop
