#include "apps/run_warnings.hpp"

#include <fmt/format.h>

#include "kinloop/base/log.hpp"

namespace kinloop {

void DepthWatch::on_frame(const FrameResult&, const PreparedFrame& frame) {
  constexpr int kStep_px = 16;  // a sample tells as much
  for (int row = 0; row < frame.depth_m.rows; row += kStep_px) {
    for (int col = 0; col < frame.depth_m.cols; col += kStep_px) {
      const auto depth_m = static_cast<double>(frame.depth_m.at<float>(row, col));
      known_ += depth_m > 0 ? 1 : 0;
      in_range_ += depth_m >= min_m_ && depth_m <= max_m_ ? 1 : 0;
    }
  }
}

double DepthWatch::share_in_range() const {
  return known_ == 0 ? 1 : static_cast<double>(in_range_) / static_cast<double>(known_);
}

void warn_of_result(const RunOutcome& o, const Trajectory& trajectory, const DepthWatch& depth) {
  constexpr double kFewInRange = 0.05;
  const bool empty = o.map_points == 0, out_of_range = depth.share_in_range() < kFewInRange;
  if ((empty || out_of_range) && !o.slam.session_log().empty()) {
    log::warn(
        "{}; check the camera's depth_scale ({} units of the depth image per metre) and dense.max_m ({} m)",
        out_of_range ? fmt::format("only {:.1f} % of the depth lies between {} and {} m",
                                   100 * depth.share_in_range(), o.options.dense.min_m, o.options.dense.max_m)
                     : "the map has no point",
        o.source.camera().depth_scale, o.options.dense.max_m);
  }
  const Trajectory& truth = o.source.info().ground_truth;
  if (!o.evaluation && !truth.empty() && !trajectory.empty())
    log::warn("the ground truth tells no error: {}", why_not_evaluated(trajectory, truth));
}

std::string loss_text(const Map& map) {
  if (map.keyframes().empty()) return "no frame had enough key points with depth to begin with";
  return "tracking was lost and its place not recognised again";
}

}  // namespace kinloop
