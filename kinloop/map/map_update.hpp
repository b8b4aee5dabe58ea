#pragma once

#include <utility>
#include <vector>

#include "kinloop/map/keyframe.hpp"
#include "kinloop/map/loop_closure.hpp"

namespace kinloop {

/// Pairs (from, into) of landmarks that are the same point.
using LandmarkMerges = std::vector<std::pair<LandmarkId, LandmarkId>>;

/// The landmarks that a loop closure identifies.
struct LoopMerges {
  LoopEnds loop;
  LandmarkMerges merges;
};

/// A landmark that a loop closure has merged into another, as it was before: what is needed to take that
/// back.
struct MergedLandmark {
  Landmark from;
  LandmarkId into;
  KeyframeId newest;  ///< keyframe of the map then
};

/// Changes computed by background work on a copied problem, addressed by id. Entries whose ids no longer
/// exist are skipped.
struct MapUpdate {
  std::vector<std::pair<KeyframeId, SE3>> T_world_camera;  ///< corrected keyframe poses
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>>
      p_world;  ///< corrected landmarks, consistent with those poses
  std::vector<std::pair<LandmarkId, Observation>> outliers;  ///< observations to remove
  std::vector<LoopMerges> merges;
  KeyframeId newest_keyframe;  ///< keyframes added after it follow its correction rigidly
  uint32_t epoch = 0;  ///< epoch of the map when the problem was copied; stale if older than the map's
};

}  // namespace kinloop
