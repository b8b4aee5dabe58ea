#pragma once
// Whether two parts of a map can be one room. The double of a place is furnished alike, but not at the same
// distances: where the views beside a loop overlap, one sees through the walls of the other. Another floor is
// furnished alike at the same distances, but has other pictures.

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "kinloop/loop/verification/view_checks.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/map/view_difference.hpp"

namespace kinloop {

/// What a keyframe shows. Unlike the keyframe it can be compared while the map changes.
struct KeyframeView {
  KeyframeId id;
  uint32_t component = 0;
  uint32_t visit = 0;
  SE3 T_world_camera;
  std::shared_ptr<const Features> features;
  std::shared_ptr<const SurfaceGrid> surfaces;  ///< of what is at rest; null if they are not known
};

KeyframeView view_of(const Keyframe& keyframe);

/// Two views that should show the same.
struct OverlappingViews {
  KeyframeView a, b;
  SE3 T_a_b;
  double away_m = 0;  ///< from a loop between them: the farther, the more drift
};

/// Returns the pose of the world of `loop.b` in that of `loop.a`, if the loop is true.
SE3 T_world_a_world_b(const LoopClosure& loop, const SE3& T_world_a, const SE3& T_world_b);

/// Returns the one of the keyframes, or of their views, that fulfils `is_wanted` and is nearest to a pose;
/// null if none overlaps.
template <class View, class IsWanted>
const View* nearest_view(const std::vector<View>& views, const SE3& T_world_camera,
                         const IsWanted& is_wanted) {
  const View* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const View& view : views) {
    if (!is_wanted(view)) continue;
    const auto difference = view_difference(view.T_world_camera, T_world_camera);
    if (!difference || *difference >= least) continue;
    least = *difference;
    nearest = &view;
  }
  return nearest;
}

/// Compares how two views look and what size things have in them. They are aligned first, since drift makes
/// them look different; nullopt if that fails.
std::optional<ViewComparison> compare_aligned(const OverlappingViews& views, const Sensor& sensor);

/// How pairs of views look, which takes long to find out.
class AppearanceCache {
 public:
  /// Compares two views as `compare_aligned`, or returns what they said before at nearly the same relative
  /// pose, from which alignment leads to the same one.
  std::optional<ViewComparison> compare(const OverlappingViews& views, const Sensor& sensor);

 private:
  struct Pair {
    SE3 T_a_b;
    std::optional<ViewComparison> comparison;
  };
  std::map<std::pair<KeyframeId, KeyframeId>, Pair> pairs_;
};

/// What the keyframes of one part of a map say of another.
struct RoomComparison {
  DepthConsistency depths;
  AppearanceTally appearance;  ///< of the pairs of keyframes that could be compared
};

/// A loop that would join two components.
struct Join {
  LoopClosure loop;
  int required_views = 0;  ///< fewer pairs of views need not be compared
};

/// Joins of components, and all that their judgement needs of the map.
struct JoinProblem {
  std::vector<Join> joins;
  std::vector<KeyframeView> views;  ///< of all keyframes, by id
  AppearanceCache cache;            ///< known before
  Sensor sensor;
  uint32_t epoch = 0;  ///< of the map
};

/// What the views say of joins.
struct ComparedJoins {
  std::map<LoopEnds, RoomComparison> rooms;
  AppearanceCache cache;
  uint32_t epoch = 0;
};

/// Compares for each join each view of the component of `loop.b` with the one of the component of `loop.a`
/// that is nearest to it, if the loop is true. Allows for drift with the distance from the loop. Views of
/// which too few overlap are not compared.
ComparedJoins compare_rooms(const JoinProblem& problem);

/// Returns whether so many keypoints violate free space, or so many views look different, that these are
/// different rooms.
bool contradicts_same_room(const RoomComparison& comparison);

}  // namespace kinloop
