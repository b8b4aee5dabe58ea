#pragma once
// In: a grey image. Out: its pyramid, and evenly spread FAST corners with orientations on all levels.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/options.hpp"

namespace kinloop {

/// A corner on one pyramid level.
struct Corner {
  int level = 0;
  int x = 0;  ///< whole pixels of the level
  int y = 0;
  float dx = 0;  ///< subpixel offset from (x, y), pixels of the level
  float dy = 0;
  float angle_deg = 0;  ///< [0, 360), clockwise as y points down
};

/// Returns the pyramid of a grey image, level 0 first, each level `scale_factor` smaller than the previous
/// one. Levels too small for corners are left out.
std::vector<cv::Mat> build_pyramid(const cv::Mat& gray, const FeatureOptions& options);

/// Detects oriented corners on all levels, about `options.count` at most, distributed over the levels by side
/// length. Stronger corners are preferred, but each further corner in an image cell counts for less.
std::vector<Corner> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options);

}  // namespace kinloop
