#include "apps/run/frame_recorder.hpp"

namespace kinloop {
namespace {

const char* to_string(TrackStatus status) {
  switch (status) {
    case TrackStatus::kTracked:
      return "tracked";
    case TrackStatus::kDenseOnly:
      return "dense";
    case TrackStatus::kLost:
      return "lost";
  }
  return "";
}

}  // namespace

void FrameRecorder::on_frame(const FrameResult& result, const PreparedFrame& frame) {
  rows_.push_back({result.stamp_ns, to_string(result.status), static_cast<int>(frame.features->size()),
                   result.stats.inliers, 0});
}

FrameTable FrameRecorder::table(const Timings& times) const {
  FrameTable rows = rows_;
  for (size_t i = 0; i < rows.size() && i < times.frame_ms.size(); ++i) rows[i].ms = times.frame_ms[i];
  return rows;
}

}  // namespace kinloop
