#include "tools/calibration/capture.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/quantile.hpp"
#include "tools/calibration/board/find_board.hpp"

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

StillCapture::StillCapture(std::filesystem::path folder, const Board& board, StillKind kind, size_t wanted)
    : folder_(std::move(folder)), board_(board), kind_(kind), guide_(wanted) {
  require_writable_folder(folder_);
  if (!std::filesystem::is_empty(folder_)) {
    throw InputError(fmt::format(
        "{}: not empty; use a new folder with --live, or omit --live to calibrate from its images",
        folder_.string()));
  }
}

CaptureFeedback StillCapture::process(const Frame& frame) {
  if (kind_ == StillKind::kPairs && frame.infrared.empty()) {
    throw InputError("--live: this source has no infrared images; use a Kinect 2 (kinect2)");
  }
  CaptureFeedback feedback;
  const cv::Mat color = frame.color.bgr();
  feedback.view = find_board(color, board_);
  if (feedback.view && kind_ == StillKind::kPairs && !find_board(frame.infrared, board_)) {
    feedback.hint = "the infrared camera does not see the board: move it into view, avoid reflections";
    return feedback;
  }
  const CaptureAdvice advice =
      guide_.advise(feedback.view, feedback.view ? edge_width_px(color, *feedback.view) : 0);
  feedback.hint = advice.hint;
  feedback.kept = advice.keep;
  if (feedback.kept) write(frame);
  return feedback;
}

void StillCapture::write(const Frame& frame) const {
  constexpr double kMillimetres = 1000;
  const auto file = [&](const char* ending) {
    return folder_ / fmt::format("{:04}{}.png", guide_.kept(), ending);
  };
  if (kind_ == StillKind::kColor) return write_png(file(""), frame.color.bgr());
  write_png(file("_color"), frame.color.bgr());
  write_png(file("_ir"), frame.infrared);
  write_depth_png(file("_depth"), frame.depth_m, kMillimetres);
}

}  // namespace kinloop
