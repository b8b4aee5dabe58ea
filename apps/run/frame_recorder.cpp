#include "apps/run/frame_recorder.hpp"

#include <algorithm>
#include <chrono>

#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

const char* frame_status(const FrameRecord& tracked) {
  if (tracked.is_lost()) return "lost";
  if (tracked.is_doubtful()) return "doubtful";
  if (tracked.method == TrackingMethod::kPredicted) return "predicted";
  return tracked.method == TrackingMethod::kDense ? "dense" : "tracked";
}

void FrameRecorder::record_pose(const TrackedFrame& tracked) {
  using Milliseconds = std::chrono::duration<double, std::milli>;
  if (const auto read_at = tracked.frame->time.read_at)
    latencies_ms_.push_back(Milliseconds(std::chrono::steady_clock::now() - *read_at).count());
  ages_ms_.push_back(Milliseconds(std::chrono::system_clock::now().time_since_epoch()).count() -
                     1e-6 * static_cast<double>(tracked.stamp_ns));
  if (tracked.is_lost() || tracked.is_doubtful()) return;
  live_poses_.push_back(
      {feature_counts_.size(), tracked.component, {tracked.stamp_ns, tracked.T_world_camera}});
  if (with_covariances_) covariances_.push_back(tracked.world_covariance);
}

void FrameRecorder::on_frame(const TrackedFrame& tracked) {
  if (!live_poses_.empty() && live_poses_.back().frame == feature_counts_.size())
    live_poses_.back().component = tracked.component;  // mapping the frame may have changed it
  feature_counts_.push_back(static_cast<int>(tracked.features().size()));
}

FrameTable FrameRecorder::table(std::span<const LoggedFrame> log, const Timings& times) const {
  FrameTable rows;
  for (size_t i = 0; i < std::min(feature_counts_.size(), log.size()); ++i) {
    const LoggedFrame& frame = log[i];
    const double ms = i < times.frame_ms.size() ? times.frame_ms[i] : 0;
    const double sigma_m = frame.is_lost() ? 0 : position_sigma_m(frame.world_covariance);
    const TrackingEvidence& evidence = frame.evidence;
    rows.push_back({frame.stamp_ns, frame_status(frame), feature_counts_[i], evidence.inliers, ms, sigma_m,
                    std::string(name_of(frame.trust.cause)), evidence.visible_landmarks,
                    evidence.surfaces.contradicted_share(), evidence.moved_share});
  }
  return rows;
}

std::vector<PoseWithCovariance> FrameRecorder::live_poses(std::span<const LoggedFrame> log,
                                                          const Map& map) const {
  const uint32_t component = main_component(log, map);
  std::vector<PoseWithCovariance> poses;
  for (size_t i = 0; i < live_poses_.size(); ++i) {
    const GivenPose& live = live_poses_[i];
    if (live.frame >= log.size() || live.component != component ||
        !is_tracked_in(component, log[live.frame], map))
      continue;
    const auto& [stamp_ns, T_world_camera] = live.pose;
    poses.push_back({stamp_ns, T_world_camera, with_covariances_ ? covariances_[i] : Matrix6d::Zero()});
  }
  return poses;
}

}  // namespace kinloop
