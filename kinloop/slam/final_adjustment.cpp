#include "kinloop/slam/final_adjustment.hpp"

#include <cmath>

#include "kinloop/base/time.hpp"
#include "kinloop/mapping/local_adjustment.hpp"
#include "kinloop/optimize/bundle_model.hpp"

namespace kinloop {
namespace {

constexpr int64_t kMaxNeighbourNs = 150'000'000;  // farther apart, a hand's velocity has changed

BundleObservation bundle_observation(const LoggedObservation& seen) {
  BundleObservation o;
  o.pixel = seen.pixel.cast<double>();
  o.depth_m = static_cast<double>(seen.depth_m);
  o.sigma_px = static_cast<double>(seen.sigma_px);
  o.row = static_cast<double>(seen.row);
  o.inverse_depth_gradient = seen.inverse_depth_gradient.cast<double>();
  return o;
}

/// Turns what a moving, imperfect camera measured into what an ideal one at rest would have: the residual
/// against the model of the real one is kept, the prediction replaced by the ideal one. Exact at
/// `T_world_camera`, and good to first order around it.
PoseObservation idealize(const BundleTask& task, const LoggedObservation& seen, const BundleView& view,
                         const Eigen::Vector3d& p_world, const SensorVector& sensor) {
  const BundleObservation o = bundle_observation(seen);
  const BundleUse use = o.depth_m > 0 ? BundleUse::kPixelAndDepth : BundleUse::kPixel;
  const BundleResidual residual = bundle_residual(task, o, use, view, p_world, sensor);
  PoseObservation ideal{p_world, o.pixel, o.depth_m, o.sigma_px};
  const Eigen::Vector3d p_camera = view.R_camera_world * (p_world - view.center);
  if (!residual.seen || !(p_camera.z() > 0)) return ideal;
  ideal.pixel = task.problem.camera.project(p_camera) - o.sigma_px * residual.e.head<2>();
  const double inverse_depth = 1 / p_camera.z() + task.options.inverse_depth_sigma_per_m * residual.e.z();
  if (o.depth_m > 0) ideal.depth_m = inverse_depth > 0 ? 1 / inverse_depth : 0;
  return ideal;
}

SE3 refined_pose(const LoggedFrame& entry, const SE3& T_world_camera, const Map& map, const BundleTask& task,
                 const Velocity& velocity, const SensorVector& sensor, const AbsolutePoseOptions& options) {
  constexpr int kMinInliers = 20;  // a frame whose landmarks are mostly gone keeps what tracking found
  const BundleView view(T_world_camera, velocity);
  std::vector<PoseObservation> observations;
  for (const LoggedObservation& seen : entry.observations) {
    if (!map.contains(seen.landmark)) continue;
    observations.push_back(idealize(task, seen, view, map.p_world(seen.landmark), sensor));
  }
  const auto solution = solve_absolute_pose(task.problem.camera, observations, T_world_camera, options);
  return solution && solution->inlier_count >= kMinInliers ? solution->T_reference_camera : T_world_camera;
}

/// How far each parameter may be off; 0 = held. The scale of depth is that of the world and cannot be found.
SensorVector expected_sigmas(const PinholeCamera& camera, const SelfCalibrationOptions& options) {
  SensorVector sigma = SensorVector::Zero();
  sigma(kFocalX) = options.focal_sigma * camera.fx;
  sigma(kFocalY) = options.focal_sigma * camera.fy;
  sigma(kCenterX) = sigma(kCenterY) = options.center_sigma_px;
  sigma(kRadial1) = sigma(kRadial2) = options.radial_sigma;
  sigma(kRollingShutter) = sigma(kDepthShutter) = sigma(kDepthTime) = options.time_sigma_s;
  for (int k = kDepthOffset; k <= kDepthOffsetYY; ++k) sigma(k) = options.depth_offset_sigma_per_m;
  return sigma;
}

/// Holds the parameters that the data told too little about.
void judge(const BundleSolution& solution, const SensorVector& expected, double max_sigma_share,
           SensorEstimate& estimate) {
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (expected(k) == 0) continue;
    const double sigma = std::sqrt(std::max(solution.sensor_covariance(k, k), 0.0));
    const bool narrowed = sigma <= max_sigma_share * expected(k);
    estimate.sigma(k) = sigma;
    estimate.used[static_cast<size_t>(k)] = narrowed;
    estimate.value(k) = narrowed ? solution.sensor(k) : 0;
  }
}

std::vector<Velocity> keyframe_velocities(const FrameLog& log, const Map& map) {
  const auto of_frames = frame_velocities(log, map);
  std::vector<Velocity> velocities(map.keyframes().size(), Velocity::Zero());
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].keyframe.valid()) velocities[log[i].keyframe.value] = of_frames[i];
  }
  return velocities;
}

}  // namespace

std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map) {
  std::vector<Velocity> velocities(log.size(), Velocity::Zero());
  const auto usable = [&](size_t i, size_t other) {
    return log[other].status != TrackStatus::kLost &&
           std::abs(log[i].stamp_ns - log[other].stamp_ns) < kMaxNeighbourNs;
  };
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].status == TrackStatus::kLost) continue;
    const size_t before = i > 0 && usable(i, i - 1) ? i - 1 : i;
    const size_t after = i + 1 < log.size() && usable(i, i + 1) ? i + 1 : i;
    const int64_t duration_ns = log[after].stamp_ns - log[before].stamp_ns;
    if (duration_ns <= 0) continue;
    const SE3 T_world_before = world_pose(log[before], map), T_world_after = world_pose(log[after], map);
    const Eigen::Matrix3d R_camera_world = world_pose(log[i], map).R().transpose();
    const double duration_s = to_seconds(duration_ns);
    velocities[i] << R_camera_world * (T_world_after.translation - T_world_before.translation) / duration_s,
        log_so3(T_world_before.rotation.conjugate() * T_world_after.rotation) / duration_s;
  }
  return velocities;
}

FrameLog refine_frames(const FrameLog& log, const Map& map, const PinholeCamera& camera,
                       const SensorVector& sensor, const AbsolutePoseOptions& options) {
  BundleProblem problem;
  problem.camera = camera;
  BundleOptions bundle;
  bundle.inverse_depth_sigma_per_m = options.inverse_depth_sigma_per_m;
  const BundleTask task{problem, bundle, {}, {}, {}};
  const auto velocities = frame_velocities(log, map);
  FrameLog refined = log;
  for (size_t i = 0; i < log.size(); ++i) {
    LoggedFrame& entry = refined[i];
    if (entry.keyframe.valid()) {
      entry.reference = entry.keyframe;
      entry.T_reference_camera = SE3{};
    } else if (entry.status == TrackStatus::kTracked) {
      const SE3 T_world_camera =
          refined_pose(entry, world_pose(entry, map), map, task, velocities[i], sensor, options);
      entry.T_reference_camera = map.keyframe(entry.reference).T_world_camera.inverse() * T_world_camera;
    }
  }
  return refined;
}

SensorEstimate adjust_finally(Map& map, FrameLog& log, const PinholeCamera& camera,
                              const BundleOptions& bundle, const AbsolutePoseOptions& pose,
                              const SelfCalibrationOptions& options, const Progress& progress) {
  SensorEstimate estimate;
  if (map.keyframes().size() < 2) return estimate;
  const SensorVector expected = expected_sigmas(camera, options);
  const int passes = options.enabled ? options.passes : 0;
  // The first pass takes the camera as ideal and gives the velocities that the others need.
  for (int pass = 0; pass <= passes; ++pass) {
    AdjustmentProblem problem = full_problem(map, camera);
    if (pass > 0) {
      problem.bundle.velocities = keyframe_velocities(log, map);
      problem.bundle.sensor.value = estimate.value;
      for (int k = 0; k < kSensorParameterCount; ++k) {
        const bool held = pass > 1 && !estimate.used[static_cast<size_t>(k)];
        problem.bundle.sensor.prior_sigma(k) = held ? 0 : expected(k);
      }
    }
    const BundleSolution solution = solve_bundle(problem.bundle, bundle);
    map.apply(update_of(problem, solution));
    if (pass == 1) judge(solution, expected, options.max_sigma_share, estimate);
    if (pass > 1) estimate.value = solution.sensor;
    log = refine_frames(log, map, camera, estimate.value, pose);
    if (!report(progress, "adjusting", static_cast<size_t>(pass) + 1, static_cast<size_t>(passes) + 1)) break;
  }
  return estimate;
}

}  // namespace kinloop
