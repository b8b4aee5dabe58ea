#pragma once
// FAST corners over an image pyramid, spread evenly.

#include <vector>

#include <opencv2/core/types.hpp>

#include "kinloop/features/options.hpp"

namespace kinloop {

/// The pyramid of a grey image, level 0 first, each level `scale_factor` smaller than the one before.
std::vector<cv::Mat> build_pyramid(const cv::Mat& gray, const FeatureOptions& options);

/// Oriented corners of the pyramid in pixels of level 0, with `octave`, `angle` (degrees) and `size` as
/// cv::ORB has them; at most `options.count`, each level with its share by area, evenly over the image.
std::vector<cv::KeyPoint> detect_corners(const std::vector<cv::Mat>& pyramid, const FeatureOptions& options);

}  // namespace kinloop
