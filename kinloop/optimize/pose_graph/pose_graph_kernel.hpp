#pragma once
// The robust kernels of the pose graph, chosen by name, the same for all solvers.

#include <algorithm>
#include <string>

#include "kinloop/base/errors.hpp"
#include "kinloop/geometry/robust_loss.hpp"

namespace kinloop {

/// Replaces s = e' Omega e by rho(s) in the cost; weight(s) = d rho / d s.
struct PoseGraphKernel {
  enum class Kind { kNone, kHuber, kCauchy, kGemanMcClure, kDcs };

  Kind kind = Kind::kNone;
  double width = 1;  ///< standard deviations

  [[nodiscard]] double rho(double s) const {
    const double c2 = width * width;
    switch (kind) {
      case Kind::kNone:
        return s;
      case Kind::kHuber:
        return HuberLoss{width}.rho(s);
      case Kind::kCauchy:
        return CauchyLoss{width}.rho(s);
      case Kind::kGemanMcClure:
        return c2 * s / (c2 + s);
      case Kind::kDcs:
        return s <= c2 ? s : c2 * (3 * s - c2) / (c2 + s);
    }
    return s;
  }

  [[nodiscard]] double weight(double s) const {
    const double c2 = width * width;
    switch (kind) {
      case Kind::kNone:
        return 1;
      case Kind::kHuber:
        return HuberLoss{width}.weight(s);
      case Kind::kCauchy:
        return CauchyLoss{width}.weight(s);
      case Kind::kGemanMcClure:
        return c2 * c2 / ((c2 + s) * (c2 + s));
      case Kind::kDcs:
        return dcs_scale(s) * dcs_scale(s);
    }
    return 1;
  }

 private:
  /// Dynamic covariance scaling, Eq. (15) of Agarwal et al. 2013 with Phi = width^2; its square integrates to
  /// rho.
  [[nodiscard]] double dcs_scale(double s) const {
    const double phi = width * width;
    return std::min(1.0, 2 * phi / (phi + s));
  }
};

/// The kernel of that name ("none", "huber", "cauchy", "geman-mcclure", "dcs").
inline PoseGraphKernel pose_graph_kernel(const std::string& name, double width) {
  using Kind = PoseGraphKernel::Kind;
  if (name == "huber") return {Kind::kHuber, width};
  if (name == "cauchy") return {Kind::kCauchy, width};
  if (name == "geman-mcclure") return {Kind::kGemanMcClure, width};
  if (name == "dcs") return {Kind::kDcs, width};
  require(name == "none", "pose graph: unknown robust kernel");
  return {Kind::kNone, width};
}

}  // namespace kinloop
