#include "kinloop/compare/match_picture.hpp"

#include <opencv2/imgproc.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/random.hpp"

namespace kinloop {

cv::Mat draw_matches(const cv::Mat& gray_a, const Features& a, const cv::Mat& gray_b, const Features& b,
                     const std::vector<LookAlike>& matches) {
  require(gray_a.size() == gray_b.size() && gray_a.type() == CV_8UC1 && gray_b.type() == CV_8UC1,
          "draw_matches: two grey images of one size");
  constexpr int kCircleRadius = 3;
  cv::Mat side_by_side, picture;
  cv::hconcat(gray_a, gray_b, side_by_side);
  cv::cvtColor(side_by_side, picture, cv::COLOR_GRAY2BGR);
  Random random(1);
  for (const LookAlike& match : matches) {
    const Eigen::Vector2f from = a.raw_pixels[match.a], to = b.raw_pixels[match.b];
    const cv::Point start(cvRound(from.x()), cvRound(from.y()));
    const cv::Point end(gray_a.cols + cvRound(to.x()), cvRound(to.y()));
    const double hue = random.uniform(0, 1);  // bright colours, far apart
    const cv::Scalar color(255 * std::abs(1 - 2 * hue), 255 * (1 - std::abs(1 - 2 * hue)),
                           255 * random.uniform(0, 1));
    cv::line(picture, start, end, color, 1, cv::LINE_AA);
    cv::circle(picture, start, kCircleRadius, color, 1, cv::LINE_AA);
    cv::circle(picture, end, kCircleRadius, color, 1, cv::LINE_AA);
  }
  return picture;
}

}  // namespace kinloop
