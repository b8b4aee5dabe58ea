#pragma once
// In: an image and its depth. Out: keypoints, by default ORB's (Rublee et al. 2011) spread evenly over the
// image, undistorted, with depths and descriptors.

#include <optional>

#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/features/options.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Keypoints of a grey image (8UC1). `depth_m` (32FC1, same size) may be empty: then all depths are unknown.
Features extract_features(const cv::Mat& gray, const cv::Mat& depth_m, const PinholeCamera& camera,
                          const FeatureOptions& options);

/// Depth at a raw pixel, averaged over the 3x3 around it; 0 where unknown or where the depth steps by more
/// than `max_relative_step` (a keypoint on an edge may belong to either side).
float average_depth(const cv::Mat& depth_m, const Eigen::Vector2f& raw_pixel, double max_relative_step);

/// How inverse depth changes over the image around a raw pixel, 1/m per px; nothing where depth is missing
/// there or the surface is no plane.
std::optional<Eigen::Vector2f> inverse_depth_gradient(const cv::Mat& depth_m,
                                                      const Eigen::Vector2f& raw_pixel);

}  // namespace kinloop
