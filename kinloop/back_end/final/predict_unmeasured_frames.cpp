#include <optional>
#include <utility>

#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/frames/frame_velocities.hpp"

namespace kinloop {
namespace {

/// Of a velocity between two frames 1/30 s apart with errors of 2 mm and 1 mrad each.
Velocity velocity_noise() {
  return {Eigen::Vector3d::Constant(0.08), Eigen::Vector3d::Constant(0.04)};
}

/// Whether nothing was measured: the frame is lost, or its image has been that of an earlier one for long.
bool is_unmeasured(const LoggedFrame& entry) {
  return entry.is_lost() || (entry.is_repeat() && entry.is_doubtful());
}

/// Whether the place was recognized, and no later frame has confirmed it.
bool is_unconfirmed(const LoggedFrame& entry) {
  return entry.trust.cause == DoubtCause::kPlace;
}

/// Whether an end of a bridge may be here.
bool is_held(const LoggedFrame& entry) {
  return !entry.is_lost() && !entry.is_doubtful();
}

MovingCamera moving_camera(const FrameLog& log, size_t i, const Map& map) {
  return {log[i].stamp_ns, log[i].world(map), frame_velocity(log, i, map)};
}

/// The acceleration noise of the frames that have a pose, from the changes of their velocity.
AccelerationNoise acceleration_noise(const FrameLog& log, size_t first, const Map& map) {
  AccelerationNoise sum;
  int count = 0;
  std::optional<size_t> previous;
  Velocity before;
  for (size_t i = first; i < log.size(); ++i) {
    if (!is_held(log[i]) || log[i].is_repeat()) continue;
    const Velocity now = frame_velocity(log, i, map);
    const double interval_s = previous ? to_seconds(log[i].stamp_ns - log[*previous].stamp_ns) : 0;
    constexpr double kMaxInterval_s = 0.15;  // over which frame_velocity is known
    if (interval_s > 0 && interval_s < kMaxInterval_s) {
      sum.linear_m2_s3 += (now.linear_m_s - before.linear_m_s).squaredNorm() / (3 * interval_s);
      sum.angular_rad2_s3 += (now.angular_rad_s - before.angular_rad_s).squaredNorm() / (3 * interval_s);
      ++count;
    }
    previous = i;
    before = now;
  }
  if (count == 0) return {};
  return {sum.linear_m2_s3 / count, sum.angular_rad2_s3 / count};
}

}  // namespace

FrameLog predict_unmeasured_frames(FrameLog log, size_t first, const Map& map, double max_sigma_m) {
  constexpr double kMaxBridge_s = 3;
  std::optional<AccelerationNoise> noise;
  std::optional<size_t> previous;  // the last frame that was measured
  for (size_t i = first; i < log.size(); ++i) {
    if (is_unmeasured(log[i]) || is_unconfirmed(log[i])) continue;
    const std::optional<size_t> start = std::exchange(previous, i);
    if (!start || *start + 1 == i || !is_held(log[*start]) || !is_held(log[i])) continue;
    const uint32_t component = map.keyframe(log[*start].reference).component;
    if (!is_tracked_in(component, log[i], map)) continue;
    if (to_seconds(log[i].stamp_ns - log[*start].stamp_ns) > kMaxBridge_s) continue;
    if (!noise) noise = acceleration_noise(log, first, map);
    const MovingCamera before = moving_camera(log, *start, map), after = moving_camera(log, i, map);
    const SE3 T_reference_world = map.keyframe(log[*start].reference).T_world_camera.inverse();
    for (size_t k = *start + 1; k < i; ++k) {
      const BridgedPose pose = bridge_motion(before, after, log[k].stamp_ns, *noise, velocity_noise());
      const bool is_certain = position_sigma_m(pose.covariance) <= max_sigma_m;
      LoggedFrame& entry = log[k];
      if (is_unconfirmed(entry)) {
        const PredictedView predicted{pose.T_world_camera, pose.covariance};
        if (is_certain && is_tracked_in(component, entry, map) && is_explained(predicted, entry.world(map)))
          entry.trust = {};
        continue;
      }
      entry.outcome = TrackingOutcome::kTracked;
      entry.method = TrackingMethod::kPredicted;
      entry.reference = log[*start].reference;
      entry.T_reference_camera = T_reference_world * pose.T_world_camera;
      entry.covariance = pose.covariance;
      entry.trust = {};
      if (!is_certain) doubt(entry, DoubtCause::kUnmeasured);
    }
  }
  return log;
}

}  // namespace kinloop
