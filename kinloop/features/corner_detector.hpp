#pragma once
// In: a grey image. Out: its pyramid, and FAST corners over the pyramid, spread evenly, with directions.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/options.hpp"

namespace kinloop {

/// A corner of one level of the pyramid.
struct Corner {
  int level = 0;
  int x = 0;  ///< whole pixels of the level
  int y = 0;
  float strength = 0;   ///< comparable between corners of an image
  float angle_deg = 0;  ///< [0, 360), clockwise as y points down
};

/// The pyramid of a grey image, level 0 first, each level `scale_factor` smaller than the one before, as
/// cv::ORB makes it. It ends early where a level would be too small for corners.
std::vector<cv::Mat> build_pyramid(const cv::Mat& gray, const FeatureOptions& options);

/// Oriented corners of the pyramid; at most about `options.count`, each level with its share by side length,
/// evenly over the image.
std::vector<Corner> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options);

}  // namespace kinloop
