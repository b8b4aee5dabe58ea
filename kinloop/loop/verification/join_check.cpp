#include "kinloop/loop/verification/join_check.hpp"

#include <algorithm>
#include <limits>

namespace kinloop {
namespace {

using Loops = std::vector<LoopEnds>;

/// The visits that a loop closure joins; nullopt if it is within one.
std::optional<VisitPair> joined_visits(const LoopClosure& loop, const Map& map) {
  const uint32_t a = map.keyframe(loop.a).visit, b = map.keyframe(loop.b).visit;
  if (a == b) return std::nullopt;
  return std::minmax(a, b);
}

/// The loop closures between visits.
std::map<VisitPair, Loops> loops_between_visits(const Map& map) {
  std::map<VisitPair, Loops> joined;
  for (const LoopClosure& loop : map.loop_closures()) {
    if (const auto visits = joined_visits(loop, map)) joined[*visits].push_back(loop.ends());
  }
  return joined;
}

/// The distance of a keyframe from the nearest end of loops in its visit, along a straight line.
double distance_from(const Loops& loops, const Keyframe& keyframe, const Map& map) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const LoopEnds& loop : loops) {
    const Keyframe& end = map.keyframe(map.keyframe(loop.a).visit == keyframe.visit ? loop.a : loop.b);
    const double away_m = (keyframe.T_world_camera.translation - end.T_world_camera.translation).norm();
    least_m = std::min(least_m, away_m);
  }
  return least_m;
}

/// Whether it is known what rests in the view of a keyframe: people must not make a place look different.
bool knows_what_rests(const Keyframe& keyframe) {
  return keyframe.surfaces != nullptr && !keyframe.withdrawn;
}

/// The nearest view of the earlier visit; nullopt if there is none, or too far from the loops.
std::optional<OverlappingViews> views_of(const VisitPair& visits, const Keyframe& later, const Loops& loops,
                                         const Map& map) {
  constexpr double kMaxDistance_m = 4;
  if (later.visit != visits.second || !knows_what_rests(later)) return std::nullopt;
  const double away_m = distance_from(loops, later, map);
  if (away_m > kMaxDistance_m) return std::nullopt;
  const Keyframe* earlier = nearest_view(map.keyframes(), later.T_world_camera, [&](const Keyframe& view) {
    return view.visit == visits.first && view.component == later.component && knows_what_rests(view);
  });
  if (earlier == nullptr) return std::nullopt;
  return OverlappingViews{view_of(*earlier), view_of(later), map.relative_pose(earlier->id, later.id),
                          away_m};
}

}  // namespace

ViewPairResult compare_joined(const OverlappingViews& views, const Sensor& sensor) {
  return {{views.a.visit, views.b.visit}, compare_aligned(views, sensor)};
}

bool JoinCheck::has_views(const Map& map) const {
  const auto& loops = map.loop_closures();
  return std::any_of(loops.begin(), loops.end(), [&](const LoopClosure& loop) {
    const auto visits = joined_visits(loop, map);
    if (!visits) return false;
    const auto known = joins_.find(*visits);
    return known == joins_.end() || known->second.next_keyframe < map.keyframes().size();
  });
}

std::vector<OverlappingViews> JoinCheck::take_views(const Map& map) {
  std::vector<OverlappingViews> taken;
  for (const auto& [visits, loops] : loops_between_visits(map)) {
    uint32_t& next = joins_[visits].next_keyframe;
    for (; next < map.keyframes().size(); ++next) {
      auto views = views_of(visits, map.keyframe(KeyframeId{next}), loops, map);
      if (views) taken.push_back(*std::move(views));
    }
  }
  return taken;
}

void JoinCheck::add(const std::vector<ViewPairResult>& results) {
  for (const auto& [visits, views] : results) {
    if (views) joins_[visits].appearance.add(*views);
  }
}

std::vector<LoopEnds> JoinCheck::take_contradicted(const Map& map, int min_views) {
  const auto joined = loops_between_visits(map);
  std::erase_if(joins_, [&](const auto& entry) { return !joined.contains(entry.first); });
  std::vector<LoopEnds> contradicted;
  for (const auto& [visits, loops] : joined) {
    const auto join = joins_.find(visits);
    if (join == joins_.end()) continue;
    const AppearanceTally& appearance = join->second.appearance;
    if (appearance.views < min_views || !appearance.contradicts_same_place()) continue;
    contradicted.insert(contradicted.end(), loops.begin(), loops.end());
    joins_.erase(join);
  }
  return contradicted;
}

}  // namespace kinloop
