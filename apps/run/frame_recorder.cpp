#include "apps/run/frame_recorder.hpp"

namespace kinloop {

const char* frame_status(const TrackedFrame& tracked) {
  if (tracked.is_lost()) return "lost";
  if (tracked.doubtful) return "doubtful";
  return tracked.method == TrackingMethod::kDense ? "dense" : "tracked";
}

void FrameRecorder::on_frame(const TrackedFrame& tracked) {
  rows_.push_back({tracked.stamp_ns, frame_status(tracked), static_cast<int>(tracked.features().size()),
                   tracked.evidence.inliers, 0, 0});
  if (tracked.is_lost() || tracked.doubtful) return;
  online_poses_.push_back({tracked.stamp_ns, tracked.T_world_camera, tracked.world_covariance});
}

FrameTable FrameRecorder::table(std::span<const TrackedFrame> log, const Timings& times) const {
  FrameTable rows = rows_;
  for (size_t i = 0; i < rows.size() && i < times.frame_ms.size(); ++i) rows[i].ms = times.frame_ms[i];
  for (size_t i = 0; i < rows.size() && i < log.size(); ++i) {
    rows[i].status = frame_status(log[i]);
    if (log[i].is_lost()) continue;
    rows[i].tracked = log[i].evidence.inliers;
    rows[i].sigma_m = position_sigma_m(log[i].world_covariance);
  }
  return rows;
}

}  // namespace kinloop
