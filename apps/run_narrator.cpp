#include "apps/run_narrator.hpp"

#include <fmt/format.h>

#include "kinloop/base/log.hpp"
#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

constexpr size_t kKeyframesPerLine = 10;

const char* words_for(const FrameResult& result) {
  if (result.relocalized) return "relocalised";
  switch (result.status) {
    case TrackStatus::kTracked:
      return "tracking";
    case TrackStatus::kDenseOnly:
      return "tracking by depth and grey values alone";
    case TrackStatus::kLost:
      return "lost";
  }
  return "";
}

}  // namespace

void RunNarrator::on_frame(const FrameResult& result, const PreparedFrame&) {
  if (result.status != status_ || result.relocalized) {
    log::info("frame {} ({} s): {}, {} landmarks seen", result.frame.value, format_stamp(result.stamp_ns),
              words_for(result), result.stats.inliers);
  }
  status_ = result.status;
}

void RunNarrator::on_map(const Map& map) {
  for (; loops_told_ < map.loop_edges().size(); ++loops_told_) {
    const LoopEdge& loop = map.loop_edges()[loops_told_];
    log::info("loop closed: keyframe {} ({} s) is met again at keyframe {} ({} s), {} matches", loop.a.value,
              format_stamp(map.keyframe(loop.a).stamp_ns), loop.b.value,
              format_stamp(map.keyframe(loop.b).stamp_ns), loop.inliers);
  }
  if (map.keyframes().size() >= keyframes_told_ + kKeyframesPerLine) {
    keyframes_told_ = map.keyframes().size();
    log::info("{} keyframes, {} landmarks", keyframes_told_, map.landmark_count());
  }
}

std::string run_note(const FrameResult& result, const Map& map) {
  return fmt::format("{}, {} keyframes, {} loops", words_for(result), map.keyframes().size(),
                     map.loop_edges().size());
}

}  // namespace kinloop
