#pragma once
// In: two images and the matches between them. Out: a picture, as Fig. 3 and 4 of the founding paper.

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/feature_comparison/evaluate_pair.hpp"

namespace kinloop {

/// Both grey images side by side, the tops of both at the top, each match a line of a colour of its own
/// (8UC3, BGR).
cv::Mat draw_matches(const cv::Mat& gray_a, const Features& a, const cv::Mat& gray_b, const Features& b,
                     const std::vector<DescriptorMatch>& matches);

/// The picture with lines of text below it (ASCII, as OpenCV's letters).
cv::Mat add_caption(const cv::Mat& picture, const std::vector<std::string>& lines);

}  // namespace kinloop
