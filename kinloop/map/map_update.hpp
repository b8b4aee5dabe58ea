#pragma once

#include <utility>
#include <vector>

#include "kinloop/map/keyframe.hpp"

namespace kinloop {

/// What slow work on a copied problem wants changed, addressed by ids. What no longer exists when it is
/// applied is passed over.
struct MapUpdate {
  std::vector<std::pair<KeyframeId, SE3>> T_world_camera;       ///< corrected keyframe poses
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> p_world;  ///< corrected landmarks, with those poses
  std::vector<std::pair<LandmarkId, Observation>> outliers;     ///< observations to forget
  std::vector<std::pair<LandmarkId, LandmarkId>> merges;        ///< (from, into): the same point
  KeyframeId newest_keyframe;  ///< keyframes added after it follow its correction rigidly
  uint32_t epoch = 0;  ///< of the map when the problem was copied; an older epoch than the map's is stale
};

}  // namespace kinloop
