#include "kinloop/calibration/still_capture.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/output_check.hpp"
#include "kinloop/calibration/edge_width.hpp"
#include "kinloop/calibration/find_board.hpp"
#include "kinloop/sensor/image_file.hpp"

namespace kinloop {

StillCapture::StillCapture(std::filesystem::path folder, const Board& board, StillKind kind, size_t wanted)
    : folder_(std::move(folder)), board_(board), kind_(kind), guide_(wanted) {
  require_writable_folder(folder_);
  if (!std::filesystem::is_empty(folder_)) {
    throw InputError(fmt::format(
        "{}: is not empty; give a new folder to --live, or leave --live out to calibrate from what is there",
        folder_.string()));
  }
}

StillNews StillCapture::take(const RgbdFrame& frame) {
  if (kind_ == StillKind::kPairs && frame.infrared.empty()) {
    throw InputError("--live: this source gives no infrared images; a Kinect 2 does (kinect2)");
  }
  StillNews news;
  news.view = find_board(frame.color, board_);
  if (news.view && kind_ == StillKind::kPairs && !find_board(frame.infrared, board_)) {
    news.hint = "the infrared camera does not see the board: into its view, no reflections";
    return news;
  }
  const StillAdvice advice = guide_.look(news.view, news.view ? edge_width_px(frame.color, *news.view) : 0);
  news.hint = advice.hint;
  news.kept = advice.keep;
  if (news.kept) write(frame);
  return news;
}

void StillCapture::write(const RgbdFrame& frame) const {
  constexpr double kMillimetres = 1000;
  const auto file = [&](const char* ending) {
    return folder_ / fmt::format("{:04}{}.png", guide_.kept(), ending);
  };
  if (kind_ == StillKind::kColor) return write_png(file(""), frame.color);
  write_png(file("_color"), frame.color);
  write_png(file("_ir"), frame.infrared);
  write_depth_png(file("_depth"), frame.depth_m, kMillimetres);
}

}  // namespace kinloop
