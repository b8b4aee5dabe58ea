#pragma once

#include "kinloop/features/options.hpp"
#include "kinloop/geometry/depth_noise.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/slam/self_calibration.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// When background jobs run and when their results are applied.
enum class ExecutorMode { kInline, kLagged, kLive };

constexpr auto option_names(ExecutorMode) {
  return std::to_array<EnumName<ExecutorMode>>(
      {{ExecutorMode::kInline, "inline"}, {ExecutorMode::kLagged, "lagged"}, {ExecutorMode::kLive, "live"}});
}

/// Execution of slow work beside tracking.
struct ExecutorOptions {
  ExecutorMode mode = ExecutorMode::kLagged;
  int local_ba_lag_frames = 5;
  int loop_verification_lag_frames = 3;
  int loop_correction_lag_frames = 8;
  int global_ba_lag_frames = 30;
  int dense_lag_frames = 5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("mode", self.mode,
          "inline: run background jobs synchronously; lagged: run them in parallel and apply results a fixed "
          "number of frames later (same result every run); live: apply results when ready");
    visit("local_ba_lag_frames", self.local_ba_lag_frames,
          "frames until a local bundle adjustment is applied", Range{1, 1000}, Expert{});
    visit("loop_verification_lag_frames", self.loop_verification_lag_frames,
          "frames until a loop verification is applied", Range{1, 1000}, Expert{});
    visit("loop_correction_lag_frames", self.loop_correction_lag_frames,
          "frames until a loop correction is applied", Range{1, 1000}, Expert{});
    visit("global_ba_lag_frames", self.global_ba_lag_frames,
          "frames until a global bundle adjustment is applied", Range{1, 1000}, Expert{});
    visit("dense_lag_frames", self.dense_lag_frames, "frames until a keyframe's surfels are applied",
          Range{1, 1000}, Expert{});
  }
};

/// Measurement noise, used by tracking, loop verification and bundle adjustment.
struct NoiseOptions {
  double inverse_depth_sigma_per_m = kKeypointInverseDepthSigmaPerM;
  double robust_width = kKeypointRobustWidth;
  double inlier_chi2_pixel = kChi2At95With2Dof;
  double inlier_chi2_depth = kChi2At95With1Dof;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "inverse_depth_sigma_per_m", self.inverse_depth_sigma_per_m,
        "standard deviation of the inverse depth of a Kinect 1 at keypoints, 1/m; about four times that on "
        "planes, because keypoints lie on edges; that of another sensor (camera.yaml, sensor) is greater or "
        "smaller in the same ratio",
        Range{1e-6, 1});
    visit("robust_width", self.robust_width, "scale of the Huber loss, standard deviations", Range{0.1, 1e9});
    visit("inlier_chi2_pixel", self.inlier_chi2_pixel,
          "maximum squared pixel residual of an inlier (95 % of chi2, 2 DoF)", Range{0.1, 1e12}, Expert{});
    visit("inlier_chi2_depth", self.inlier_chi2_depth,
          "maximum squared depth residual; beyond it only the pixel is used (95 % of chi2, 1 DoF)",
          Range{0.1, 1e12}, Expert{});
  }
};

/// Options of a whole run. `noise` overrides the noise values in the solver options (`resolve_options`).
struct SlamOptions {
  int seed = 1;
  int min_initial_keypoints = 60;
  int lost_frames_before_new_component = 5;
  bool global_ba_enabled = true;
  bool localize_only = false;
  int keyframe_memory_mib = 1024;
  NoiseOptions noise;
  FeatureOptions features;
  TrackingOptions tracking;
  LocalMapOptions local_map;
  MappingOptions mapping;
  LoopOptions loop;
  BundleOptions global_ba = {.tolerance = 1e-3};  // a smaller change is below measurement noise
  SelfCalibrationOptions self_calibration;
  ExecutorOptions executor;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("seed", self.seed, "random seed", Range{0, 1e9});
    visit("min_initial_keypoints", self.min_initial_keypoints,
          "minimum keypoints with depth to initialise the map", Range{10, 10000});
    visit("lost_frames_before_new_component", self.lost_frames_before_new_component,
          "consecutive lost frames before a new map component is started, to be merged when a "
          "place is recognised; 0 = never",
          Range{0, 100000});
    visit("global_ba_enabled", self.global_ba_enabled,
          "run global bundle adjustment after loop closures and at the end");
    visit("localize_only", self.localize_only, "localise in a loaded map without changing it", Expert{});
    visit(
        "keyframe_memory_mib", self.keyframe_memory_mib,
        "memory for descriptors and patches of keyframes before the oldest are spilled to a temporary file, "
        "MiB",
        Range{0, 1e6});
    visit("noise", self.noise);
    visit("features", self.features);
    visit("tracking", self.tracking);
    visit("local_map", self.local_map);
    visit("mapping", self.mapping);
    visit("loop", self.loop);
    visit("global_ba", self.global_ba);
    visit("self_calibration", self.self_calibration);
    visit("executor", self.executor);
  }

  static OptionHistory history();
};

/// Returns the noise of depth at keypoints, for a sensor with `sensor_noise` on planes.
DepthNoise keypoint_noise(const NoiseOptions& noise, const DepthNoise& sensor_noise);

/// Returns the options that the modules use: `noise`, and the noise of the sensor, copied to every solver,
/// and the pose solver of tracking copied to RANSAC. Throws UsageError with key, value and expected range if
/// a value is not allowed.
SlamOptions resolve_options(SlamOptions options, const DepthNoise& sensor_noise = {});

}  // namespace kinloop
