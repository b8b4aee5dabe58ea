#include "apps/run/frame_recorder.hpp"

namespace kinloop {
namespace {

const char* status_of(const TrackedFrame& tracked) {
  if (tracked.is_lost()) return "lost";
  return tracked.method == TrackingMethod::kDense ? "dense" : "tracked";
}

}  // namespace

void FrameRecorder::on_frame(const TrackedFrame& tracked) {
  rows_.push_back({tracked.stamp_ns, status_of(tracked), static_cast<int>(tracked.features().size()),
                   tracked.evidence.inliers, 0});
}

FrameTable FrameRecorder::table(const Timings& times) const {
  FrameTable rows = rows_;
  for (size_t i = 0; i < rows.size() && i < times.frame_ms.size(); ++i) rows[i].ms = times.frame_ms[i];
  return rows;
}

}  // namespace kinloop
