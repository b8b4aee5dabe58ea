#include "apps/run_narrator.hpp"

#include <memory>

#include <fmt/format.h>

#include "kinloop/base/log.hpp"
#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

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
    const int seen = result.stats.inliers;
    log::info("frame {} ({} s): {}{}", result.frame.value, format_stamp(result.stamp_ns), words_for(result),
              seen > 0 ? fmt::format(", {} landmarks seen", seen) : "");
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
  for (; keyframes_told_ < map.keyframes().size(); ++keyframes_told_) {
    const Keyframe& keyframe = map.keyframes()[keyframes_told_];
    log::info("keyframe {} ({} s), {} landmarks in the map", keyframes_told_, format_stamp(keyframe.stamp_ns),
              map.landmark_count());
  }
}

void narrate_start(const FrameSource& source, int threads) {
  const SourceInfo& info = source.info();
  const RgbdCamera& camera = source.camera();
  const PinholeCamera& lens = camera.color;
  log::info("{}: {}, {} true poses, {} thread(s)", info.name,
            info.live ? std::string("live") : fmt::format("{} frames", info.frames), info.ground_truth.size(),
            threads);
  log::info("camera {} x {}, fx {}, fy {}, cx {}, cy {}, depth in {} units a metre{}", lens.width,
            lens.height, lens.fx, lens.fy, lens.cx, lens.cy, camera.depth_scale,
            camera.depth ? ", depth camera of its own" : "");
}

Progress narrate_stages() {
  return [stage = std::make_shared<std::string>("mapping")](const ProgressReport& now) {
    if (now.stage != *stage) log::info("{}", now.stage);
    *stage = now.stage;
    return true;
  };
}

std::string run_note(const FrameResult& result, const Map& map) {
  return fmt::format("{}, {} keyframes, {} loops", words_for(result), map.keyframes().size(),
                     map.loop_edges().size());
}

}  // namespace kinloop
