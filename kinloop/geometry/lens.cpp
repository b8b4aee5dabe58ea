#include "kinloop/geometry/lens.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Denominators of the rational model are at least this, so that its pole gives large numbers, not NaN.
constexpr double kLeastDenominator = 1e-9;

/// Closer to the axis a fisheye lens does not distort, to the last digit.
constexpr double kOnAxis = 1e-9;

double denominator(const LensDistortion& c, double r2) {
  return std::max(1 + r2 * (c.k4 + r2 * (c.k5 + r2 * c.k6)), kLeastDenominator);
}

/// Distorted coordinates and their 2x2 Jacobian with respect to the ideal ones.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

Distorted distort_polynomial(const LensDistortion& c, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y();
  const double r2 = x * x + y * y;
  double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  double slope = 2 * (c.k1 + r2 * (2 * c.k2 + 3 * r2 * c.k3));  // (d radial / d r2) * 2
  if (c.model == LensModel::kRational) {
    const double below = denominator(c, r2);
    radial /= below;
    slope = (slope - radial * 2 * (c.k4 + r2 * (2 * c.k5 + 3 * r2 * c.k6))) / below;
  }
  Distorted d;
  d.point = {x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
             y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
  d.jacobian << radial + x * x * slope + 2 * c.p1 * y + 6 * c.p2 * x,
      x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y, x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y,
      radial + y * y * slope + 6 * c.p1 * y + 2 * c.p2 * x;
  return d;
}

double fisheye_radius(const LensDistortion& c, double angle) {
  const double a2 = angle * angle;
  return angle * (1 + a2 * (c.k1 + a2 * (c.k2 + a2 * (c.k3 + a2 * c.k4))));
}

double fisheye_slope(const LensDistortion& c, double angle) {
  const double a2 = angle * angle;
  return 1 + a2 * (3 * c.k1 + a2 * (5 * c.k2 + a2 * (7 * c.k3 + a2 * 9 * c.k4)));
}

/// Solves f(s) = target on the first increasing branch of f from f(0) = 0; returns its end if f does not
/// reach the target there, and at most `end`.
template <class Function>
double solve_on_first_branch(const Function& f, double target, double end) {
  constexpr int kSteps = 400, kHalvings = 60;
  double low = 0, reached = 0;
  for (int i = 1; i <= kSteps; ++i) {
    double high = end * i * i / (kSteps * kSteps);  // finest near the axis
    const double value = f(high);
    if (value >= target) {
      for (int k = 0; k < kHalvings; ++k) {
        const double middle = (low + high) / 2;
        (f(middle) < target ? low : high) = middle;
      }
      return high;
    }
    if (!(value > reached)) return low;
    low = high, reached = value;
  }
  return end;
}

/// Newton's method; nullopt if it does not converge to a point within a field of view.
std::optional<Eigen::Vector2d> newton(const LensDistortion& lens, const Eigen::Vector2d& target,
                                      Eigen::Vector2d p) {
  constexpr int kMaxIterations = 20;
  constexpr double kLastStep = 1e-10;  // convergence is quadratic: the error is below 1e-12
  for (int i = 0; i < kMaxIterations; ++i) {
    const Distorted d = distort_polynomial(lens, p);
    const Eigen::Vector2d step = d.jacobian.inverse() * (target - d.point);
    if (!step.allFinite()) return std::nullopt;
    p += step;
    if (step.squaredNorm() < kLastStep * kLastStep) {
      // Beyond a fold one eigenvalue is negative, or both.
      const bool in_view =
          d.jacobian.determinant() > 0 && d.jacobian.trace() > 0 && p.norm() < LensDistortion::kMaxRadius;
      return in_view ? std::optional(p) : std::nullopt;
    }
  }
  return std::nullopt;
}

Eigen::Vector2d undistort_polynomial(const LensDistortion& lens, const Eigen::Vector2d& target) {
  if (const auto p = newton(lens, target, target)) return *p;
  const double radius = target.norm();
  if (!(radius > 0)) return target;
  const Eigen::Vector2d direction = target / radius;
  // Without the tangential part, which is small, the equation has one unknown.
  const auto radial = [&](double r) {
    const double r2 = r * r, above = 1 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
    return lens.model == LensModel::kRational ? r * above / denominator(lens, r2) : r * above;
  };
  const Eigen::Vector2d nearest =
      solve_on_first_branch(radial, radius, LensDistortion::kMaxRadius) * direction;
  return newton(lens, target, nearest).value_or(nearest);
}

Eigen::Vector2d undistort_fisheye(const LensDistortion& lens, const Eigen::Vector2d& target) {
  const double radius = target.norm();
  if (!(radius > kOnAxis)) return target;
  const double max_angle = std::atan(LensDistortion::kMaxRadius);
  constexpr int kMaxIterations = 20;
  constexpr double kLastStep = 1e-12;
  double angle = std::min(radius, max_angle);
  bool converged = false;
  for (int i = 0; i < kMaxIterations && !converged; ++i) {
    const double slope = fisheye_slope(lens, angle);
    const double step = (radius - fisheye_radius(lens, angle)) / slope;
    angle += step;
    if (!(slope > 0) || !(angle >= 0) || !(angle <= max_angle)) break;
    converged = std::abs(step) < kLastStep;
  }
  if (!converged)
    angle = solve_on_first_branch([&](double a) { return fisheye_radius(lens, a); }, radius, max_angle);
  return std::tan(angle) / radius * target;
}

/// Pointers to the coefficients of a model in OpenCV's order.
std::vector<double LensDistortion::*> members_of(LensModel model) {
  using Lens = LensDistortion;
  if (model == LensModel::kKannalaBrandt) return {&Lens::k1, &Lens::k2, &Lens::k3, &Lens::k4};
  std::vector<double Lens::*> members = {&Lens::k1, &Lens::k2, &Lens::p1, &Lens::p2, &Lens::k3};
  if (model == LensModel::kRational) members.insert(members.end(), {&Lens::k4, &Lens::k5, &Lens::k6});
  return members;
}

}  // namespace

bool LensDistortion::is_identity() const {
  return model != LensModel::kKannalaBrandt && k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0 &&
         k4 == 0 && k5 == 0 && k6 == 0;
}

Eigen::Vector2d LensDistortion::distort(const Eigen::Vector2d& ideal) const {
  if (model != LensModel::kKannalaBrandt) return distort_polynomial(*this, ideal).point;
  const double radius = ideal.norm();
  if (!(radius > kOnAxis)) return ideal;
  return fisheye_radius(*this, std::atan(radius)) / radius * ideal;
}

Eigen::Matrix2d LensDistortion::distort_jacobian(const Eigen::Vector2d& ideal) const {
  if (model != LensModel::kKannalaBrandt) return distort_polynomial(*this, ideal).jacobian;
  const double radius = ideal.norm();
  if (!(radius > kOnAxis)) return Eigen::Matrix2d::Identity();
  const double angle = std::atan(radius);
  const double outward = fisheye_slope(*this, angle) / (1 + radius * radius);
  const double across = fisheye_radius(*this, angle) / radius;
  const Eigen::Vector2d direction = ideal / radius;
  return across * Eigen::Matrix2d::Identity() + (outward - across) * direction * direction.transpose();
}

Eigen::Vector2d LensDistortion::undistort(const Eigen::Vector2d& distorted) const {
  return model == LensModel::kKannalaBrandt ? undistort_fisheye(*this, distorted)
                                            : undistort_polynomial(*this, distorted);
}

std::vector<double> lens_coefficients(const LensDistortion& lens) {
  std::vector<double> coefficients;
  for (const auto member : members_of(lens.model)) coefficients.push_back(lens.*member);
  return coefficients;
}

LensDistortion lens_with(LensModel model, std::span<const double> coefficients) {
  const auto members = members_of(model);
  require(coefficients.size() == members.size(), "lens_with: wrong number of coefficients");
  LensDistortion lens;
  lens.model = model;
  for (size_t i = 0; i < members.size(); ++i) lens.*members[i] = coefficients[i];
  return lens;
}

LinearDistortion linear_distortion(const LensDistortion& lens, const Eigen::Vector2d& ideal) {
  const double x = ideal.x(), y = ideal.y(), r2 = x * x + y * y;
  LinearDistortion linear{ideal, {}, {}};
  if (lens.model == LensModel::kKannalaBrandt) {
    const double r = std::sqrt(r2), angle = std::atan(r), a2 = angle * angle;
    const double scale = r > kOnAxis ? angle / r : 1;
    linear.constant *= scale;
    linear.along_x << a2, a2 * a2, a2 * a2 * a2, a2 * a2 * a2 * a2, 0;
    linear.along_y = y * scale * linear.along_x;
    linear.along_x *= x * scale;
    return linear;
  }
  linear.along_x << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2;
  linear.along_y << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
  if (lens.model == LensModel::kRational) {
    const double below = denominator(lens, r2);
    linear.constant /= below;
    for (auto* row : {&linear.along_x, &linear.along_y}) {
      (*row)(0) /= below, (*row)(1) /= below, (*row)(4) /= below;
    }
  }
  return linear;
}

void set_linear_coefficients(LensDistortion& lens,
                             const Eigen::Matrix<double, LinearDistortion::kTerms, 1>& k) {
  lens.k1 = k(0), lens.k2 = k(1);
  if (lens.model == LensModel::kKannalaBrandt) {
    lens.k3 = k(2), lens.k4 = k(3);
  } else {
    lens.p1 = k(2), lens.p2 = k(3), lens.k3 = k(4);
  }
}

}  // namespace kinloop
