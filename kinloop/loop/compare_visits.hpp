#pragma once
// Whether two parts of a map can be one room. The double of a place is furnished alike, but not at the same
// distances: where the views beside a loop overlap, one sees through the walls of the other.

#include "kinloop/loop/view_checks.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// What the keyframes of one part say of the other.
struct RoomComparison {
  DepthConsistency depths;
  Looks looks;  ///< of the pairs of keyframes that were compared
};

/// Returns the pose of the world of `loop.b` in that of `loop.a`, if the loop is true.
SE3 T_world_a_world_b(const Map& map, const LoopClosure& loop);

/// Compares each keyframe of the component of `loop.b` with the one of the component of `loop.a` whose view
/// is nearest to its own, if the loop is true. Allows for drift with the distance from the loop.
RoomComparison compare_components(const Map& map, const LoopClosure& loop, const Sensor& sensor);

/// Returns whether so many keypoints violate free space, or so many views look different, that these are
/// different rooms.
bool refutes_same_room(const RoomComparison& comparison);

}  // namespace kinloop
