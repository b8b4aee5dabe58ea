#pragma once
// In: a coloured cloud. Out: a picture of it from above, straight or oblique.

#include <limits>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dense/cloud/colored_cloud.hpp"

namespace kinloop {

struct CloudPictureOptions {
  Eigen::Vector3d up = {0, -1,
                        0};   ///< in the world frame; default: the y axis of the first camera points down
  double elevation_deg = 55;  ///< elevation of the viewer above the horizon; 90 = straight from above
  /// Points higher than this along `up` are left out, to look into rooms with a ceiling.
  double cut_above_m = std::numeric_limits<double>::infinity();
  double point_m = 0.01;  ///< size of a point, the edge of a voxel
  int width_px = 1400;    ///< the height follows from the aspect ratio of the cloud
};

/// Renders the cloud in parallel projection, its long side horizontal and its tall side at the back, with
/// shading at depth edges. 8UC4 (BGRA), transparent where empty; empty for a cloud without drawable points.
cv::Mat render_cloud(const ColoredCloud& cloud, const CloudPictureOptions& view);

}  // namespace kinloop
