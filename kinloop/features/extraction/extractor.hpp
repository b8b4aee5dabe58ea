#pragma once
// In: an image and its depth. Out: undistorted keypoints with depths and descriptors, evenly spread over the
// image; ORB by default (Rublee et al. 2011).

#include <optional>

#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/features/options.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Extracts keypoints from a grey image (8UC1). `depth_m` (32FC1, same size) may be empty; then all depths
/// are unknown. Keypoints where `mask` (8UC1, same size; may be empty) is 0 are left out. The corrections of
/// the sensor are not used.
Features extract_features(const cv::Mat& gray, const cv::Mat& depth_m, const Sensor& sensor,
                          const FeatureOptions& options, const cv::Mat& mask = {});

/// Returns whether a raw pixel is to be used: `mask` is empty or not 0 there.
bool is_used(const cv::Mat& mask, const Eigen::Vector2f& raw_pixel);

/// Returns the depth at a raw pixel, averaged over its 3x3 neighbourhood; 0 if unknown or if depth jumps by
/// more than `max_relative_step` (a keypoint on an edge may belong to either side).
float average_depth(const cv::Mat& depth_m, const Eigen::Vector2f& raw_pixel, double max_relative_step);

/// Returns the gradient of inverse depth around a raw pixel, 1/m per raw px; nullopt if depth is missing or
/// the surface is not planar, given the noise of the sensor.
std::optional<Eigen::Vector2f> inverse_depth_gradient(const cv::Mat& depth_m,
                                                      const Eigen::Vector2f& raw_pixel, const Sensor& sensor);

/// What an image and its depth tell of a keypoint, in the undistorted image.
struct KeypointSample {
  Eigen::Vector2f pixel;
  float sigma_px = 1;
  float depth_m = 0;                       ///< z, 0 = unknown
  Eigen::Vector2f inverse_depth_gradient;  ///< 1/m per px; NaN if unknown
};

/// Samples `depth_m`, which may be empty, around a raw pixel with a standard deviation of `raw_sigma_px`.
/// The lens stretches both: near the border of a fisheye image many undistorted pixels are one raw pixel.
KeypointSample sample_keypoint(const cv::Mat& depth_m, const Eigen::Vector2d& raw_pixel, float raw_sigma_px,
                               const Sensor& sensor, const FeatureOptions& options);

}  // namespace kinloop
