#include "apps/run/run_logger.hpp"

#include <memory>

#include <fmt/format.h>

#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

const char* describe_tracking(const TrackedFrame& tracked) {
  if (tracked.is_lost()) return "lost";
  if (tracked.is_doubtful()) return "doubtful";
  if (tracked.outcome == TrackingOutcome::kRelocalized) return "relocalised";
  return tracked.method == TrackingMethod::kDense ? "tracking by depth and intensity only" : "tracking";
}

}  // namespace

void RunLogger::on_frame(const TrackedFrame& tracked) {
  const std::string_view state = describe_tracking(tracked);
  if (state != state_ || tracked.outcome == TrackingOutcome::kRelocalized) {
    const int seen = tracked.evidence.inliers;
    log::info("frame {} ({} s): {}{}", tracked.id.value, format_stamp(tracked.stamp_ns), state,
              seen > 0 ? fmt::format(", {} landmarks observed", seen) : "");
  }
  state_ = state;
}

void RunLogger::on_map(const Map& map) {
  const auto log_loop = [&](const LoopClosure& loop, std::string_view what) {
    log::info("loop {}: keyframe {} ({} s) matches keyframe {} ({} s), {} inliers, {} keyframes: {}", what,
              loop.a.value, format_stamp(map.keyframe(loop.a).stamp_ns), loop.b.value,
              format_stamp(map.keyframe(loop.b).stamp_ns), loop.evidence.inliers, loop.support,
              name_of(loop.reason));
  };
  for (const LoopClosure& loop : map.loop_closures()) {
    if (loops_logged_.insert(loop.ends()).second) log_loop(loop, "closed");
  }
  for (const LoopClosure& loop : map.other_loops()) {
    const bool contradicted = loop.stage != LoopStage::kProvisional;
    if (contradicted && refuted_logged_.insert(loop.ends()).second) log_loop(loop, name_of(loop.stage));
  }
  for (; keyframes_logged_ < map.keyframes().size(); ++keyframes_logged_) {
    const Keyframe& keyframe = map.keyframes()[keyframes_logged_];
    log::info("keyframe {} ({} s), {} landmarks in the map", keyframes_logged_,
              format_stamp(keyframe.stamp_ns), map.landmark_count());
  }
}

void log_recognition(const FrameSource& source) {
  const SourceInfo& info = source.info();
  if (!info.description.empty()) log::info("{}: {}", info.name, info.description);
}

void log_run_start(const FrameSource& source, int threads) {
  const SourceInfo& info = source.info();
  const RgbdCamera& camera = source.camera();
  const PinholeCamera& lens = camera.color;
  log::info("{}: {}, {} ground-truth poses, {} thread(s)", info.name,
            info.live ? std::string("live") : fmt::format("{} frames", info.frames), info.ground_truth.size(),
            threads);
  log::info("camera {} x {}, fx {}, fy {}, cx {}, cy {}, {} depth units per metre{}", lens.width, lens.height,
            lens.fx, lens.fy, lens.cx, lens.cy, camera.depth_scale,
            camera.depth ? ", separate depth camera" : "");
}

Progress make_stage_logger() {
  return [stage = std::make_shared<std::string>("mapping")](const ProgressReport& now) {
    if (now.stage != *stage) log::info("{}", now.stage);
    *stage = now.stage;
    return true;
  };
}

std::string progress_note(const TrackedFrame& result, const Map& map) {
  return fmt::format("{}, {} keyframes, {} loops", describe_tracking(result), map.keyframes().size(),
                     map.loop_closures().size());
}

}  // namespace kinloop
