#pragma once
// Robust losses for iteratively reweighted least squares. `squared` is a squared normalised residual (e'
// Omega e); `rho` replaces it in the cost, `weight` = d rho / d squared multiplies its normal equations.

#include <cmath>

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

/// Cauchy's loss: grows with the logarithm, so that far outliers hardly pull.
struct CauchyLoss {
  double width = 1.0;

  [[nodiscard]] double rho(double squared) const {
    return width * width * std::log1p(squared / (width * width));
  }
  [[nodiscard]] double weight(double squared) const { return 1.0 / (1.0 + squared / (width * width)); }
};

}  // namespace kinloop
