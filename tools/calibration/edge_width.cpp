#include "tools/calibration/edge_width.hpp"

#include <algorithm>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "tools/calibration/find_board.hpp"

namespace kinloop {
namespace {

/// A window around a corner that contains only its four squares.
cv::Rect surroundings(const BoardView& view, size_t corner) {
  constexpr double kReach = 0.4;  // of the distance to the nearest corner
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    if (i != corner) nearest = std::min(nearest, (view.pixels[i] - view.pixels[corner]).norm());
  }
  const int half = std::max(2, static_cast<int>(kReach * nearest));
  const cv::Point middle(static_cast<int>(view.pixels[corner].x()),
                         static_cast<int>(view.pixels[corner].y()));
  return cv::Rect(middle.x - half, middle.y - half, 2 * half + 1, 2 * half + 1) &
         cv::Rect(0, 0, view.width, view.height);
}

}  // namespace

double edge_width_px(const cv::Mat& image, const BoardView& view) {
  require(view.pixels.size() > 1, "a board has corners");
  cv::Mat gray, along_x, along_y, slope;
  to_gray_8bit(image).convertTo(gray, CV_32FC1);
  constexpr double kPerPixel = 0.5;  // the central difference spans two pixels
  cv::Sobel(gray, along_x, CV_32F, 1, 0, 1, kPerPixel);
  cv::Sobel(gray, along_y, CV_32F, 0, 1, 1, kPerPixel);
  cv::magnitude(along_x, along_y, slope);
  std::vector<double> widths;
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    const cv::Rect window = surroundings(view, i);
    double dark = 0, bright = 0, steepest = 0;
    cv::minMaxLoc(gray(window), &dark, &bright);
    cv::minMaxLoc(slope(window), nullptr, &steepest);
    if (steepest > 0) widths.push_back((bright - dark) / steepest);
  }
  return widths.empty() ? std::numeric_limits<double>::infinity() : median(widths);
}

}  // namespace kinloop
