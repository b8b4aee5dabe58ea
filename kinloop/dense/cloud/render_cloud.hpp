#pragma once
// In: a coloured cloud. Out: a picture of it from above, or from above at a slant, to look at without a
// viewer.

#include <limits>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/dense/cloud/colored_cloud.hpp"

namespace kinloop {

struct CloudView {
  Eigen::Vector3d up = {0, -1, 0};  ///< in the world; the first camera looks along z with y down
  double elevation_deg = 55;        ///< of the eye above the horizon; 90: straight from above
  /// Points higher than this along `up` are left out, so that one sees into a room with a ceiling.
  double cut_above_m = std::numeric_limits<double>::infinity();
  double point_m = 0.01;  ///< size of a point, the edge of a voxel
  int width_px = 1400;    ///< the height follows from the cloud
};

/// The cloud in parallel projection, its long side across the picture and its high side at the back, shaded
/// at edges of depth. 8UC4 (BGRA), transparent where there is nothing; empty for an empty cloud.
cv::Mat render_cloud(const ColoredCloud& cloud, const CloudView& view);

}  // namespace kinloop
