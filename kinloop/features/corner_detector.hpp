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
  float dx = 0;  ///< from there to where it lies more exactly, pixels of the level
  float dy = 0;
  float angle_deg = 0;  ///< [0, 360), clockwise as y points down
};

/// The pyramid of a grey image, level 0 first, each level `scale_factor` smaller than the one before. It ends
/// early where a level would be too small for corners.
std::vector<cv::Mat> build_pyramid(const cv::Mat& gray, const FeatureOptions& options);

/// Oriented corners of the pyramid; at most about `options.count`, each level with its share by side length.
/// The strongest come first, but each further corner of a cell of the image counts for less.
std::vector<Corner> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options);

}  // namespace kinloop
