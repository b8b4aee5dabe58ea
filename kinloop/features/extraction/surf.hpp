#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace kinloop {

/// Keypoints (level 0 pixels, size and angle in OpenCV's convention) with a 64-vector each, N x 64 of 32FC1.
struct SurfFeatures {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

/// Returns whether this build has SURF.
bool surf_available();

/// Detects the `count` strongest SURF keypoints of an 8-bit grey image with dlib. Throws UsageError in a
/// build without dlib.
SurfFeatures detect_surf(const cv::Mat& gray, int count);

}  // namespace kinloop
