#pragma once
// In: two images and the matches between them. Out: a picture like Figs. 3 and 4 of the paper
// (docs/lab/paper.md).

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/feature_comparison/evaluate_pair.hpp"

namespace kinloop {

/// Draws both grey images side by side, aligned at the top, each match as a line in its own colour (8UC3,
/// BGR).
cv::Mat draw_matches(const cv::Mat& gray_a, const Features& a, const cv::Mat& gray_b, const Features& b,
                     const std::vector<DescriptorMatch>& matches);

/// Returns the picture with lines of text below it (ASCII, as required by OpenCV's fonts).
cv::Mat add_caption(const cv::Mat& picture, const std::vector<std::string>& lines);

}  // namespace kinloop
