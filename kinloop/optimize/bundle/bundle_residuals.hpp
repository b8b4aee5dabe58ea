#pragma once
// What the residuals of an adjusted bundle say of the noise.

#include "kinloop/optimize/bundle/bundle_model.hpp"

namespace kinloop {

/// Statistics of the residuals in use, without robust weights.
struct ResidualStatistics {
  double variance = 0;    ///< BundleSolution::residual_variance
  double clustering = 1;  ///< BundleSolution::residual_clustering
};
ResidualStatistics residual_statistics(const BundleTask& task, const BundleState& state);

}  // namespace kinloop
