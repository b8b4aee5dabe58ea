#include "kinloop/loop/join_check.hpp"

#include <algorithm>
#include <limits>

namespace kinloop {
namespace {

/// The distance of a keyframe from the nearest end of the loops in its visit, along a straight line.
double distance_from(const std::vector<LoopEnds>& loops, const Keyframe& keyframe, const Map& map) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const LoopEnds& loop : loops) {
    const Keyframe& end = map.keyframe(map.keyframe(loop.a).visit == keyframe.visit ? loop.a : loop.b);
    const double away_m = (keyframe.T_world_camera.translation - end.T_world_camera.translation).norm();
    least_m = std::min(least_m, away_m);
  }
  return least_m;
}

}  // namespace

std::vector<LoopEnds> JoinCheck::find_refuted(const Map& map, const Sensor& sensor, int min_views) {
  find_joins(map);
  std::vector<LoopEnds> refuted;
  for (auto& [visits, join] : joins_) {
    compare(visits, join, map, sensor);
    const bool decides = join.comparison.looks.views >= min_views;
    if (decides && refutes_same_room(join.comparison))
      refuted.insert(refuted.end(), join.loops.begin(), join.loops.end());
  }
  return refuted;
}

/// Brings the joins up to date with the loop closures of the map, and forgets those that were taken back.
void JoinCheck::find_joins(const Map& map) {
  for (auto& [visits, join] : joins_) join.loops.clear();
  for (const LoopClosure& loop : map.loop_closures()) {
    const uint32_t a = map.keyframe(loop.a).visit, b = map.keyframe(loop.b).visit;
    if (a == b) continue;
    joins_[std::minmax(a, b)].loops.push_back({loop.a, loop.b});
  }
  std::erase_if(joins_, [](const auto& entry) { return entry.second.loops.empty(); });
}

/// Compares the new keyframes of the later visit. Drift makes views far from a loop look different.
void JoinCheck::compare(const Visits& visits, Join& join, const Map& map, const Sensor& sensor) {
  constexpr double kMaxDistance_m = 4;
  for (; join.next_keyframe < map.keyframes().size(); ++join.next_keyframe) {
    const Keyframe& keyframe = map.keyframe(KeyframeId{join.next_keyframe});
    if (keyframe.visit != visits.second || keyframe.withdrawn) continue;
    const double away_m = distance_from(join.loops, keyframe, map);
    if (away_m > kMaxDistance_m) continue;
    const Keyframe* other = nearest_view(map, keyframe.T_world_camera, [&](const Keyframe& view) {
      return view.visit == visits.first && view.component == keyframe.component && !view.withdrawn;
    });
    if (other == nullptr) continue;
    const SE3 T_other_camera = other->T_world_camera.inverse() * keyframe.T_world_camera;
    join.comparison.add(*other, keyframe, T_other_camera, away_m, sensor);
  }
}

}  // namespace kinloop
