#include "kinloop/slam/options.hpp"

namespace kinloop {
namespace {

template <class SolverOptions>
void set_noise(SolverOptions& solver, const NoiseOptions& noise, const DepthNoise& at_keypoints) {
  solver.depth_noise = at_keypoints;
  solver.robust_width = noise.robust_width;
  solver.inlier_chi2_pixel = noise.inlier_chi2_pixel;
  solver.inlier_chi2_depth = noise.inlier_chi2_depth;
}

}  // namespace

TrackerOptions tracker_options(const SlamOptions& o) {
  return {o.features,
          o.tracking,
          o.local_map,
          o.min_initial_keypoints,
          o.lost_frames_before_new_component,
          o.localize_only,
          static_cast<uint64_t>(o.seed)};
}

MapperOptions mapper_options(const SlamOptions& o) {
  return {o.tracking.keyframe, o.local_map, o.mapping, o.localize_only};
}

PlaceOptions place_options(const SlamOptions& o) {
  return {o.tracking, o.local_map, o.loop, static_cast<uint64_t>(o.seed)};
}

BackEndOptions back_end_options(const SlamOptions& o) {
  return {o.executor, o.tracking,  o.local_map,         o.mapping,
          o.loop,     o.global_ba, o.global_ba_enabled, o.self_calibration};
}

SlamOptions resolve_options(SlamOptions options, const DepthNoise& sensor_noise) {
  validate(options);
  const NoiseOptions& noise = options.noise;
  TrackingOptions& tracking = options.tracking;
  const DepthNoise at_keypoints = keypoint_noise(noise, sensor_noise);
  set_noise(tracking.pose, noise, at_keypoints);
  set_noise(options.mapping.local_ba, noise, at_keypoints);
  set_noise(options.global_ba, noise, at_keypoints);
  tracking.pnp.pose = tracking.pose;
  // The same depth noise applies to both: they measure planes and points away from depth edges.
  const double keypoint_ratio = noise.inverse_depth_sigma_per_m / kKeypointInverseDepthSigmaPerM;
  const double sensor_ratio = sensor_noise.coefficient_per_m / kSensorInverseDepthSigmaPerM;
  tracking.rigid.depth_noise = {kPointPairInverseDepthSigmaPerM * keypoint_ratio * sensor_ratio,
                                sensor_noise.crossover_m};
  tracking.icp.depth_noise = sensor_noise.times(keypoint_ratio);
  options.loop.depth_noise = sensor_noise;
  options.features.depth_noise = sensor_noise;
  return options;
}

}  // namespace kinloop
