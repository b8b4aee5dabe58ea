#pragma once
// Bundle adjustment as problem -> MapUpdate: the problem is copied out of the map, so that it can be solved
// on another thread while the map changes.

#include <span>
#include <vector>

#include "kinloop/map/map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// A bundle problem with the keyframe, landmark and observation ids of its parts.
struct BundleAdjustmentProblem {
  BundleProblem bundle;
  std::vector<KeyframeId> keyframes;                             ///< per pose
  std::vector<LandmarkId> landmarks;                             ///< per point
  std::vector<std::pair<LandmarkId, Observation>> observations;  ///< per observation
  KeyframeId newest_keyframe;
  uint32_t epoch = 0;
};

/// Returns for each of these keyframes the oldest one among them that landmarks tie it to, directly or
/// through others of them: itself where only odometry tells how it lies to the older ones.
std::vector<KeyframeId> oldest_tied(const Map& map, std::span<const KeyframeId> keyframes);

/// Copies the newest keyframe, those that share the most landmarks with it, and all landmarks they observe;
/// other observers of these landmarks are constant.
BundleAdjustmentProblem make_local_ba_problem(const Map& map, KeyframeId newest, const Sensor& sensor,
                                              const MappingOptions& options);

/// Which measurements enter a problem.
enum class MeasurementKind {
  kMotionCompensated,  ///< those of an ideal sensor at rest
  kRaw,                ///< as measured; velocities and the prior of the sensor must be filled in
};

/// Copies every keyframe and every landmark observed twice; the first keyframe of each part that landmarks
/// tie together is constant.
BundleAdjustmentProblem make_global_ba_problem(
    const Map& map, const Sensor& sensor, MeasurementKind measured = MeasurementKind::kMotionCompensated);

/// Converts a solution to a map update.
MapUpdate make_map_update(const BundleAdjustmentProblem& problem, const BundleSolution& solution);

/// Solves the problem and returns the map update.
MapUpdate run_bundle_adjustment(const BundleAdjustmentProblem& problem, const BundleOptions& options);

}  // namespace kinloop
