#include "kinloop/slam/final_bundle_adjustment.hpp"

#include <algorithm>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/mapping/complete_tracks.hpp"
#include "kinloop/optimize/pose/rolling_shutter_pose.hpp"

namespace kinloop {
namespace {

KeypointMeasurement measurement_of(const LoggedObservation& seen, float depth_lag_s) {
  KeypointMeasurement o;
  o.depth_lag_s = static_cast<double>(depth_lag_s);
  o.pixel = seen.pixel.cast<double>();
  o.depth_m = static_cast<double>(seen.depth_m);
  o.sigma_px = static_cast<double>(seen.sigma_px);
  o.row = static_cast<double>(seen.row);
  o.inverse_depth_gradient = seen.inverse_depth_gradient.cast<double>();
  return o;
}

SE3 refined_pose(const LoggedFrame& entry, const RollingShutterPose& guess, const Map& map,
                 const PinholeCamera& camera, const SensorVector& sensor,
                 const AbsolutePoseOptions& options) {
  // A frame keeps its tracked pose if few of its landmarks are left or a correction moved them apart. Many
  // may have been culled, since a frame between keyframes is tracked against landmarks of the newest one.
  constexpr size_t kMinInliers = 20;
  std::vector<PoseObservation> observations;
  for (const LoggedObservation& seen : entry.observations) {
    const LandmarkId landmark = map.resolve_merged(seen.landmark);
    if (map.contains(landmark))
      observations.push_back({measurement_of(seen, entry.depth_lag_s), map.p_world(landmark)});
  }
  AbsolutePoseOptions strict = options;
  strict.min_inliers = static_cast<int>(std::max(kMinInliers, observations.size() / 2 + 1));
  const auto found = solve_rolling_shutter_pose(camera, sensor, observations, guess, {}, strict);
  return found ? found->T_world_camera : guess.T_world_camera;
}

/// Returns 1 for the frames on whose poses the velocities of keyframes depend: the nearest before and after
/// each that do not repeat an image.
std::vector<uint8_t> neighbours_of_keyframes(const FrameLog& log) {
  std::vector<uint8_t> marked(log.size(), 0);
  size_t previous = 0;  // the last frames that are not repeated
  bool after_keyframe = false;
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].repeat) continue;
    if (after_keyframe) marked[i] = 1;
    after_keyframe = log[i].keyframe.valid();
    if (after_keyframe) marked[previous] = 1;
    previous = i;
  }
  return marked;
}

}  // namespace

FrameLog refine_frames(FrameLog log, const Map& map, const PinholeCamera& camera, const SensorVector& sensor,
                       const AbsolutePoseOptions& options, FrameSelection which, int threads) {
  const auto velocities = frame_velocities(log, map);
  const auto selected = which == FrameSelection::kNearKeyframes ? neighbours_of_keyframes(log)
                                                                : std::vector<uint8_t>(log.size(), 1);
  std::vector<SE3> T_reference_camera(log.size());
  parallel_for(log.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const LoggedFrame& entry = log[i];
      T_reference_camera[i] = entry.T_reference_camera;
      if (entry.keyframe.valid() || entry.repeat || entry.observations.empty()) continue;
      if (entry.status != TrackStatus::kTracked) continue;
      if (selected[i] == 0) continue;
      const SE3 T_world_camera =
          refined_pose(entry, {world_pose(entry, map), velocities[i]}, map, camera, sensor, options);
      T_reference_camera[i] = map.keyframe(entry.reference).T_world_camera.inverse() * T_world_camera;
    }
  });
  for (size_t i = 0; i < log.size(); ++i) {
    LoggedFrame& entry = log[i];
    entry.T_reference_camera = T_reference_camera[i];
    if (entry.keyframe.valid()) {
      entry.reference = entry.keyframe;
      entry.T_reference_camera = SE3{};
    } else if (entry.repeat) {
      entry.reference = log[i - 1].reference;
      entry.T_reference_camera = log[i - 1].T_reference_camera;
    }
  }
  return log;
}

FinalBundleAdjustment final_bundle_adjustment(Map& map, FrameLog& log, const RgbdCamera& camera,
                                              const SensorEstimate& known, const SlamOptions& options,
                                              const Progress& progress) {
  FinalBundleAdjustment result{known, std::vector<Matrix6d>(map.keyframes().size(), Matrix6d::Zero())};
  if (map.keyframes().size() < 2) return result;
  const SelfCalibrationOptions& calibration = options.self_calibration;
  constexpr int kPassesWithoutSensor = 2;  // before and after completing tracks
  const int passes = calibration.enabled ? calibration.passes : kPassesWithoutSensor;
  BundleOptions bundle = options.global_ba;
  SensorVector expected = prior_sigmas(camera.color, calibration);
  for (int pass = 1; pass <= passes; ++pass) {
    bundle.pose_covariances = pass == passes;
    auto problem =
        make_self_calibration_problem(map, camera, keyframe_velocities(log, map), result.sensor.value);
    auto adjusted = run_self_calibration(std::move(problem), expected, calibration, bundle);
    map.apply(adjusted.update);
    result = {with_fixed_from(adjusted.sensor, result.sensor), std::move(adjusted.pose_covariance)};
    // A parameter that the first pass could not constrain stays fixed.
    for (int k = 0; k < kSensorParameterCount; ++k) {
      if (!result.sensor.used[static_cast<size_t>(k)]) expected(k) = 0;
    }
    const bool last =
        !report(progress, "bundle adjustment", static_cast<size_t>(pass), static_cast<size_t>(passes)) ||
        pass == passes;
    // The next pass needs only the velocities of keyframes.
    log = refine_frames(std::move(log), map, camera.color, result.sensor.value, options.tracking.pose,
                        last ? FrameSelection::kAll : FrameSelection::kNearKeyframes, bundle.threads);
    if (last) break;
    if (pass == 1 && options.mapping.complete_tracks) {
      complete_tracks(map, camera.color, options.local_map, options.mapping);
    }
  }
  return result;
}

}  // namespace kinloop
