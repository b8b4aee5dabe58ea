#pragma once
// Bundle adjustment as problem -> MapUpdate: the problem is copied out of the map, so that it can be solved
// on another thread while the map goes on.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/mapping/options.hpp"

namespace kinloop {

/// A bundle problem and which keyframe, landmark and observation each of its parts is.
struct BundleAdjustmentProblem {
  BundleProblem bundle;
  std::vector<KeyframeId> keyframes;                             ///< per pose
  std::vector<LandmarkId> landmarks;                             ///< per point
  std::vector<std::pair<LandmarkId, Observation>> observations;  ///< per observation
  KeyframeId newest_keyframe;
  uint32_t epoch = 0;
};

/// The newest keyframe, those that share most landmarks with it, and all landmarks they see; other keyframes
/// that see these hold the window in place.
BundleAdjustmentProblem make_local_ba_problem(const Map& map, KeyframeId newest, const PinholeCamera& camera,
                                              const MappingOptions& options);

/// Which pixels and depths enter a problem.
enum class MeasurementKind {
  kMotionCompensated,  ///< as a camera at rest would have measured them
  kRaw,                ///< as they were measured: velocities and sensor are to be filled in
};

/// Every keyframe and every landmark seen twice; the first keyframe of each component is held.
BundleAdjustmentProblem make_global_ba_problem(
    const Map& map, const PinholeCamera& camera,
    MeasurementKind measured = MeasurementKind::kMotionCompensated);

/// What a solution of the problem changes in the map.
MapUpdate make_map_update(const BundleAdjustmentProblem& problem, const BundleSolution& solution);

/// Solves the problem and says what is to change in the map.
MapUpdate run_bundle_adjustment(const BundleAdjustmentProblem& problem, const BundleOptions& options);

}  // namespace kinloop
