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

// In: a grey image. Out: keypoints of one type, always with 256-bit descriptors, so that matching and place
// recognition work with every type.

/// A keypoint in full-resolution pixels.
struct DetectedKeypoint {
  Eigen::Vector2f raw_pixel;
  int level = 0;  ///< of a pyramid with ratio `scale_factor`
  float angle_deg = 0;
};

struct DetectedKeypoints {
  int level_count = 1;
  std::vector<DetectedKeypoint> points;
  cv::Mat descriptors;  ///< N x 32 of 8UC1
};

/// Detects SIFT by OpenCV (Lowe 2004) or SURF by dlib (Bay et al. 2006), as chosen by `options.kind`, and
/// binarises the descriptors. Throws UsageError if the build has no SURF.
DetectedKeypoints detect_float_keypoints(const cv::Mat& gray, const FeatureOptions& options);

/// Returns 256 bits per row of an N x D float matrix: the sides of 256 random planes on which the row lies.
/// The fraction of differing bits estimates the angle between two rows, over pi (Charikar 2002, "Similarity
/// estimation techniques from rounding algorithms", section 3). Components come in `kinds` consecutive
/// groups; the planes ignore the mean of each group, which hardly differs between keypoints.
cv::Mat binarize_descriptors(const cv::Mat& descriptors, int kinds);

}  // namespace kinloop
