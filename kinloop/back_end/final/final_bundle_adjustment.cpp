#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/back_end/final/refine_frames.hpp"
#include "kinloop/mapping/landmark_creation.hpp"

namespace kinloop {
namespace {

// Errors of neighbouring keyframes are correlated (slope of depth, delay, what is left of the sensor's
// faults): the poses take up what they share, so the residuals do not show it. Learned on simulated sequences
// with seeds 100, 105, 106 and 109 (docs/lab/measurements.md#consistency-of-the-covariances).
constexpr double kKeyframesPerIndependent = 3;

}  // namespace

FinalBundleAdjustment final_bundle_adjustment(Map& map, FrameLog& log, const SensorEstimate& initial_estimate,
                                              const BackEndOptions& options, const Progress& progress) {
  FinalBundleAdjustment result{initial_estimate,
                               std::vector<Matrix6d>(map.keyframes().size(), Matrix6d::Zero())};
  if (map.keyframes().size() < 2) return result;
  erase_moved_landmarks(map);
  const SelfCalibrationOptions& calibration = options.self_calibration;
  constexpr int kPassesWithoutSensor = 2;  // before and after completing tracks
  const int passes = calibration.enabled ? calibration.passes : kPassesWithoutSensor;
  BundleOptions bundle = options.global_ba;
  SensorPrior prior = sensor_prior(initial_estimate, calibration);
  for (int pass = 1; pass <= passes; ++pass) {
    bundle.pose_covariances = pass == passes;
    auto problem = make_self_calibration_problem(map, result.sensor.sensor, keyframe_velocities(log, map));
    problem.bundle.prior = prior;
    auto adjusted = run_self_calibration(problem, bundle);
    map.apply(adjusted.update);
    for (Matrix6d& covariance : adjusted.pose_covariance)
      covariance *= kKeyframesPerIndependent * adjusted.residual_clustering * adjusted.residual_variance;
    result = {with_fixed_from(adjusted.sensor, result.sensor), std::move(adjusted.pose_covariance)};
    // A parameter that the first pass could not constrain stays fixed.
    for (int k = 0; k < kSensorParameterCount; ++k) {
      if (!result.sensor.used[static_cast<size_t>(k)]) prior.sigma(k) = 0;
    }
    const bool last =
        !report(progress, "bundle adjustment", static_cast<size_t>(pass), static_cast<size_t>(passes)) ||
        pass == passes;
    // The next pass needs only the velocities of keyframes.
    log = refine_frames(std::move(log), {map, result.sensor.sensor, options.tracking.pose},
                        last ? FrameSelection::kAll : FrameSelection::kNearKeyframes, bundle.threads);
    if (last) break;
    if (pass == 1 && options.mapping.complete_tracks) {
      complete_tracks(map, initial_estimate.sensor.camera, options.local_map, options.mapping);
    }
  }
  return result;
}

}  // namespace kinloop
