#pragma once
// Whether two parts of a map can be one room. The double of a place is furnished alike, but not at the same
// distances: where the views beside a loop overlap, one sees through the walls of the other. Another floor is
// furnished alike at the same distances, but has other pictures.

#include <functional>
#include <optional>

#include "kinloop/loop/view_checks.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// What the keyframes of one part say of the other.
struct RoomComparison {
  DepthConsistency depths;
  Looks looks;  ///< of the pairs of keyframes that could be compared
};

/// Returns the pose of the world of `loop.b` in that of `loop.a`, if the loop is true.
SE3 T_world_a_world_b(const Map& map, const LoopClosure& loop);

/// Returns the keyframe that fulfils `is_wanted` and whose view is nearest to a pose; null if none overlaps.
const Keyframe* nearest_view(const Map& map, const SE3& T_world_camera,
                             const std::function<bool(const Keyframe&)>& is_wanted);

/// Compares two keyframes that should show the same, `away_m` from a loop. They are aligned first, since
/// drift makes them look different; nullopt if that fails.
std::optional<ViewComparison> compare_aligned(const Keyframe& a, const Keyframe& b, const SE3& T_a_b,
                                              double away_m, const Sensor& sensor);

/// Compares each keyframe of the component of `loop.b` with the one of the component of `loop.a` whose view
/// is nearest to its own, if the loop is true. Allows for drift with the distance from the loop.
RoomComparison compare_components(const Map& map, const LoopClosure& loop, const Sensor& sensor);

/// Returns whether so many keypoints violate free space, or so many views look different, that these are
/// different rooms.
bool refutes_same_room(const RoomComparison& comparison);

}  // namespace kinloop
