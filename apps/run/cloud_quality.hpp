#pragma once
// Accuracy of a cloud of a simulated room against the room's exact surfaces.

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {

struct CloudQuality {
  size_t points = 0;
  double accuracy_median_m = 0;  ///< distance from a point to the nearest surface
  double accuracy_p95_m = 0;
  double completeness = 0;  ///< share of the visible surface that has a point within 1 cm
};

/// Evaluates a cloud; `room` must be noise-free. Visible is what every tenth of its frames sees at up to 4 m.
CloudQuality cloud_quality(const ColoredCloud& cloud, const SimulatedSource& room, const SE3& T_truth_map);

}  // namespace kinloop
