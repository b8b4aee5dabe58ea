#pragma once
// Robust kernels of the pose graph, the same for all solvers.

#include <algorithm>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// Robust kernel: replaces s = e' Omega e by rho(s) in the cost; weight(s) = d rho / d s.
struct PoseGraphKernel {
  RobustKernel kind = RobustKernel::kNone;
  double width = 1;  ///< standard deviations

  [[nodiscard]] double rho(double s) const {
    const double c2 = width * width;
    switch (kind) {
      case RobustKernel::kNone:
        return s;
      case RobustKernel::kHuber:
        return HuberLoss{width}.rho(s);
      case RobustKernel::kCauchy:
        return CauchyLoss{width}.rho(s);
      case RobustKernel::kGemanMcClure:
        return c2 * s / (c2 + s);
      case RobustKernel::kDcs:
        return s <= c2 ? s : c2 * (3 * s - c2) / (c2 + s);
    }
    return s;
  }

  [[nodiscard]] double weight(double s) const {
    const double c2 = width * width;
    switch (kind) {
      case RobustKernel::kNone:
        return 1;
      case RobustKernel::kHuber:
        return HuberLoss{width}.weight(s);
      case RobustKernel::kCauchy:
        return CauchyLoss{width}.weight(s);
      case RobustKernel::kGemanMcClure:
        return c2 * c2 / ((c2 + s) * (c2 + s));
      case RobustKernel::kDcs:
        return dcs_scale(s) * dcs_scale(s);
    }
    return 1;
  }

 private:
  /// Returns the scale of dynamic covariance scaling, Eq. (15) of Agarwal et al. 2013 with Phi = width^2; its
  /// square integrates to rho.
  [[nodiscard]] double dcs_scale(double s) const {
    const double phi = width * width;
    return std::min(1.0, 2 * phi / (phi + s));
  }
};

}  // namespace kinloop
