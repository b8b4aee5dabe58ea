#pragma once

#include "kinloop/core/ids.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// The pose of a camera relative to a keyframe, with which it moves when the map is corrected.
struct KeyframePose {
  KeyframeId reference;
  SE3 T_reference_camera;

  /// Returns T_world_camera in the current map.
  [[nodiscard]] SE3 world(const Map& map) const {
    return map.keyframe(reference).T_world_camera * T_reference_camera;
  }

  /// Returns the same pose relative to another keyframe of the same component.
  [[nodiscard]] KeyframePose in(KeyframeId other, const Map& map) const {
    if (other == reference) return *this;
    return {other, map.relative_pose(other, reference) * T_reference_camera};
  }
};

}  // namespace kinloop
