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
/// are unknown. The corrections of the sensor are not used.
Features extract_features(const cv::Mat& gray, const cv::Mat& depth_m, const Sensor& sensor,
                          const FeatureOptions& options);

/// Returns the depth at a raw pixel, averaged over its 3x3 neighbourhood; 0 if unknown or if depth jumps by
/// more than `max_relative_step` (a keypoint on an edge may belong to either side).
float average_depth(const cv::Mat& depth_m, const Eigen::Vector2f& raw_pixel, double max_relative_step);

/// Returns the gradient of inverse depth around a raw pixel, 1/m per px; nullopt if depth is missing or the
/// surface is not planar, given the noise of the sensor.
std::optional<Eigen::Vector2f> inverse_depth_gradient(const cv::Mat& depth_m,
                                                      const Eigen::Vector2f& raw_pixel, const Sensor& sensor);

}  // namespace kinloop
