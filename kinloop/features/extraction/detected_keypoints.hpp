#pragma once
// In: a grey image. Out: keypoints of one type, always with 256-bit descriptors, so that matching and place
// recognition work with every type.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/options.hpp"

namespace kinloop {

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
