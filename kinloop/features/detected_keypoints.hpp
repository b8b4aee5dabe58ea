#pragma once
// In: a grey image. Out: keypoints of one kind with descriptors of 256 bits, whatever the kind, so that all
// that matches and recognises works alike.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/options.hpp"

namespace kinloop {

/// A keypoint where the full image shows it.
struct DetectedKeypoint {
  Eigen::Vector2f raw_pixel;
  int level = 0;  ///< of a pyramid whose levels are `scale_factor` apart
  float angle_deg = 0;
};

struct DetectedKeypoints {
  int level_count = 1;
  std::vector<DetectedKeypoint> points;
  cv::Mat descriptors;  ///< N x 32 of 8UC1
};

/// SIFT by OpenCV (Lowe 2004) or SURF by dlib (Bay et al. 2006), as `options.kind` says, the descriptors made
/// binary. Throws UsageError where the build has no SURF.
DetectedKeypoints detect_float_keypoints(const cv::Mat& gray, const FeatureOptions& options);

/// 256 bits of each row of N x D floats: on which side of 256 random planes it lies. The share of bits in
/// which two rows differ estimates the angle between them, over pi (Charikar 2002, "Similarity estimation
/// techniques from rounding algorithms", section 3). Components come in `kinds`, one after the other; the
/// planes are blind to what all components of a kind have in common, which hardly differs from keypoint to
/// keypoint.
cv::Mat binarize_descriptors(const cv::Mat& descriptors, int kinds);

}  // namespace kinloop
