#include "kinloop/slam/final_adjustment.hpp"

#include <algorithm>

#include "kinloop/optimize/moving_pose.hpp"

namespace kinloop {
namespace {

BundleObservation bundle_observation(const LoggedObservation& seen) {
  BundleObservation o;
  o.pixel = seen.pixel.cast<double>();
  o.depth_m = static_cast<double>(seen.depth_m);
  o.sigma_px = static_cast<double>(seen.sigma_px);
  o.row = static_cast<double>(seen.row);
  o.inverse_depth_gradient = seen.inverse_depth_gradient.cast<double>();
  return o;
}

SE3 refined_pose(const LoggedFrame& entry, const MovingPose& guess, const Map& map,
                 const PinholeCamera& camera, const SensorVector& sensor,
                 const AbsolutePoseOptions& options) {
  // A frame whose landmarks are mostly gone, or were moved apart when the map bent, keeps what tracking
  // found.
  constexpr size_t kMinInliers = 20;
  const size_t majority = entry.observations.size() / 2 + 1;
  std::vector<MovingObservation> observations;
  for (const LoggedObservation& seen : entry.observations) {
    if (map.contains(seen.landmark)) {
      observations.push_back({map.p_world(seen.landmark), bundle_observation(seen)});
    }
  }
  AbsolutePoseOptions strict = options;
  strict.min_inliers = static_cast<int>(std::max(kMinInliers, majority));
  const auto found = solve_moving_pose(camera, sensor, observations, guess, {}, strict);
  return found ? found->T_world_camera : guess.T_world_camera;
}

}  // namespace

FrameLog refine_frames(const FrameLog& log, const Map& map, const PinholeCamera& camera,
                       const SensorVector& sensor, const AbsolutePoseOptions& options) {
  const auto velocities = frame_velocities(log, map);
  FrameLog refined = log;
  for (size_t i = 0; i < log.size(); ++i) {
    LoggedFrame& entry = refined[i];
    if (entry.keyframe.valid()) {
      entry.reference = entry.keyframe;
      entry.T_reference_camera = SE3{};
    } else if (entry.repeat) {
      entry.reference = refined[i - 1].reference;
      entry.T_reference_camera = refined[i - 1].T_reference_camera;
    } else if (entry.status == TrackStatus::kTracked) {
      const SE3 T_world_camera =
          refined_pose(entry, {world_pose(entry, map), velocities[i]}, map, camera, sensor, options);
      entry.T_reference_camera = map.keyframe(entry.reference).T_world_camera.inverse() * T_world_camera;
    }
  }
  return refined;
}

FinalAdjustment adjust_finally(Map& map, FrameLog& log, const PinholeCamera& camera,
                               const SensorEstimate& known, BundleOptions bundle,
                               const AbsolutePoseOptions& pose, const SelfCalibrationOptions& options,
                               const Progress& progress) {
  FinalAdjustment result{known, std::vector<Matrix6d>(map.keyframes().size(), Matrix6d::Zero())};
  if (map.keyframes().size() < 2) return result;
  bundle.pose_covariances = true;
  const SensorVector expected = expected_sigmas(camera, options);
  const int passes = options.enabled ? options.passes : 1;
  for (int pass = 1; pass <= passes; ++pass) {
    auto problem = calibration_problem(map, camera, keyframe_velocities(log, map), result.sensor.value);
    auto adjusted = adjust_with_sensor(std::move(problem), expected, options.max_sigma_share, bundle);
    map.apply(adjusted.update);
    result = {std::move(adjusted.sensor), std::move(adjusted.pose_covariance)};
    log = refine_frames(log, map, camera, result.sensor.value, pose);
    if (!report(progress, "adjusting", static_cast<size_t>(pass), static_cast<size_t>(passes))) break;
  }
  return result;
}

}  // namespace kinloop
