#include "tools/calibration/capture.hpp"

#include <fmt/format.h>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "tools/calibration/edge_width.hpp"
#include "tools/calibration/find_board.hpp"

namespace kinloop {

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
