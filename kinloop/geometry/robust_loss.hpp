#pragma once
// Robust losses for iteratively reweighted least squares. `squared` is a squared normalised residual (e'
// Omega e); `rho` replaces it in the cost, and `weight` = d rho / d squared scales its terms in the normal
// equations.

#include <cmath>
#include <numbers>

namespace kinloop {

/// Huber's loss: quadratic up to `width` standard deviations, linear beyond.
struct HuberLoss {
  double width = 1.0;

  [[nodiscard]] double rho(double squared) const {
    return squared <= width * width ? squared : 2 * width * std::sqrt(squared) - width * width;
  }
  [[nodiscard]] double weight(double squared) const {
    return squared <= width * width ? 1.0 : width / std::sqrt(squared);
  }
};

/// Statistical efficiency of Huber's estimate of the mean of a normal distribution: 0.64 (that of the median)
/// for width 0, 1 for an infinite width (Huber 1964, Eq. 2.9).
inline double huber_efficiency(double width) {
  if (!(width > 0)) return 2 / std::numbers::pi;
  if (std::isinf(width)) return 1;
  const double inside = std::erf(width / std::numbers::sqrt2);  // fraction of the samples within the width
  const double density = std::exp(-width * width / 2) / std::sqrt(2 * std::numbers::pi);
  return inside * inside / (inside - 2 * width * density + width * width * (1 - inside));
}

/// Cauchy's loss: grows logarithmically, so that gross outliers have little influence.
struct CauchyLoss {
  double width = 1.0;

  [[nodiscard]] double rho(double squared) const {
    return width * width * std::log1p(squared / (width * width));
  }
  [[nodiscard]] double weight(double squared) const { return 1.0 / (1.0 + squared / (width * width)); }
};

}  // namespace kinloop
