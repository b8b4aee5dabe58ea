#pragma once
// The features of an image: keypoints, their depths and descriptors.

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Keypoints of one image as a structure of arrays; all vectors and `descriptors` have one entry (row) per
/// keypoint.
struct Features {
  double scale_factor = 1.2;  ///< size ratio of one pyramid level to the next
  int level_count = 8;
  float depth_stamp_difference_s = 0;   ///< stamp of the depth image minus stamp of the colour image
  std::vector<Eigen::Vector2f> pixels;  ///< undistorted, motion-compensated
  std::vector<float> depths_m;          ///< z, motion-compensated, 0 = unknown
  /// Where each was detected, distorted; the row gives its readout time under a rolling shutter.
  std::vector<Eigen::Vector2f> raw_pixels;
  std::vector<Eigen::Vector2f> measured_pixels;  ///< undistorted, not motion-compensated
  std::vector<float> measured_depths_m;          ///< z, not motion-compensated, 0 = unknown
  /// Gradient of inverse depth over the undistorted image, 1/m per px; NaN if unknown. May be empty.
  std::vector<Eigen::Vector2f> inverse_depth_gradients;
  std::vector<int> levels;        ///< pyramid level, 0 = full resolution
  std::vector<float> angles_rad;  ///< orientation in the image
  std::vector<float> sigmas_px;   ///< standard deviation of `pixels`; grows with the level and the lens
  cv::Mat descriptors;            ///< N x 32 of 8UC1; those of SIFT and SURF are binary, too
  /// Keeps the memory of `descriptors` alive if it is not OpenCV's own.
  std::shared_ptr<const uint8_t> descriptor_storage;

  [[nodiscard]] size_t size() const { return pixels.size(); }

  /// False for landmarks found by their patches, without keypoint detection.
  [[nodiscard]] bool has_descriptors() const { return pixels.empty() || !descriptors.empty(); }
};

}  // namespace kinloop
