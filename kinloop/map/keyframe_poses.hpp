#pragma once

#include <vector>

#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns T_world_camera of all keyframes by id, as `rebased_after_split` needs those from before
/// components were parted.
inline std::vector<SE3> keyframe_poses(const Map& map) {
  std::vector<SE3> T_world_keyframe;
  for (const Keyframe& keyframe : map.keyframes()) T_world_keyframe.push_back(keyframe.T_world_camera);
  return T_world_keyframe;
}

}  // namespace kinloop
