#pragma once
// What is kept of an image: its keypoints, their depths and their descriptors.

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Keypoints of one image, structure of arrays; all vectors and `descriptors` have one entry (row) per
/// keypoint.
struct Features {
  double scale_factor = 1.2;  ///< size ratio of one pyramid level to the next
  int level_count = 8;
  std::vector<Eigen::Vector2f> pixels;  ///< undistorted, as a camera at rest sees them
  std::vector<float> depths_m;          ///< z, as a camera at rest measures it, 0 = unknown
  /// Where each was detected; its row tells its time under a rolling shutter.
  std::vector<Eigen::Vector2f> raw_pixels;
  std::vector<Eigen::Vector2f> measured_pixels;  ///< undistorted, of the camera as it moved
  std::vector<float> measured_depths_m;          ///< z, of the camera as it moved, 0 = unknown
  /// How inverse depth changes over the image at `raw_pixels`, 1/m per px; NaN where unknown. May be empty.
  std::vector<Eigen::Vector2f> inverse_depth_gradients;
  std::vector<int> levels;        ///< pyramid level, 0 = full size
  std::vector<float> angles_rad;  ///< orientation in the image
  std::vector<float> sigmas_px;   ///< standard deviation of `pixels`: grows with the level
  cv::Mat descriptors;            ///< N x 32 of 8UC1 (ORB), or N x D of 32FC1 (SIFT, SURF)

  [[nodiscard]] size_t size() const { return pixels.size(); }
};

}  // namespace kinloop
