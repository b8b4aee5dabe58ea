#include "kinloop/loop/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "kinloop/loop/compare_visits.hpp"
#include "kinloop/loop/relative_scale.hpp"

namespace kinloop {
namespace {

constexpr int kAgreeingKeyframes = 3;  // during the run
constexpr int kAgreeingKeyframesAtEnd = 2;
constexpr int kViewsOfSuspect = 20, kViewsOfSuspectAtEnd = 4;
constexpr size_t kLead = 2;  // keyframes more than those of a place that contradicts

/// The covariances of both loops and the drift between their ends: 2 to 3 % of the path, see drift.cpp.
struct CycleBound {
  double translation_m, rotation_rad;
};

CycleBound cycle_bound(const LoopClosure& x, const LoopClosure& y, double travelled_m) {
  constexpr double kSigmas = 3;
  // The information is that of x, y, z and of half the rotation angles.
  const auto sigma_m = [](const LoopClosure& loop) { return 1 / std::sqrt(loop.information(0, 0)); };
  const auto sigma_rad = [](const LoopClosure& loop) { return 2 / std::sqrt(loop.information(3, 3)); };
  return {0.02 + kSigmas * std::hypot(sigma_m(x), sigma_m(y)) + 0.03 * travelled_m,
          0.01 + kSigmas * std::hypot(sigma_rad(x), sigma_rad(y)) + 0.02 * travelled_m};
}

LoopClosure inverse(LoopClosure loop) {
  std::swap(loop.a, loop.b);
  loop.T_a_b = loop.T_a_b.inverse();
  loop.evidence.scale.factor = 1 / loop.evidence.scale.factor;
  return loop;
}

/// The other loop in the direction of the first; nullopt if they join other components.
std::optional<LoopClosure> directed_as(const LoopClosure& x, const LoopClosure& y, const Map& map) {
  const auto component = [&](KeyframeId id) { return map.keyframe(id).component; };
  if (component(x.a) == component(y.a) && component(x.b) == component(y.b)) return y;
  if (component(x.a) == component(y.b) && component(x.b) == component(y.a)) return inverse(y);
  return std::nullopt;
}

/// The distances from the ends of a loop to all keyframes.
struct EndDistances {
  std::vector<double> from_a_m, from_b_m;

  EndDistances(const Map& map, const LoopClosure& loop)
      : from_a_m(travelled_distances(map, loop.a)), from_b_m(travelled_distances(map, loop.b)) {}
};

LoopRelation relate(const Map& map, const LoopClosure& x, const EndDistances& distances,
                    const LoopClosure& other) {
  const auto y = directed_as(x, other, map);
  if (!y) return LoopRelation::kUnknown;
  const double travelled_m = distances.from_a_m[y->a.value] + distances.from_b_m[y->b.value];
  if (!std::isfinite(travelled_m)) return LoopRelation::kUnknown;
  const auto pose = [&](KeyframeId id) { return map.keyframe(id).T_world_camera; };
  const SE3 by_x = x.T_a_b * (pose(x.b).inverse() * pose(y->b));
  const SE3 by_y = (pose(x.a).inverse() * pose(y->a)) * y->T_a_b;
  const SE3 error = by_x.inverse() * by_y;
  const CycleBound bound = cycle_bound(x, *y, travelled_m);
  const double excess =
      std::max(error.translation.norm() / bound.translation_m, error.angle_rad() / bound.rotation_rad);
  constexpr double kMaxTravelled_m = 6;  // beyond, agreement says little
  constexpr double kClearly = 2;
  if (excess > kClearly) return LoopRelation::kContradict;
  return excess <= 1 && travelled_m <= kMaxTravelled_m ? LoopRelation::kAgree : LoopRelation::kUnknown;
}

/// The loops that agree with one, and how many keyframes support and contradict it.
struct Group {
  std::vector<size_t> waiting;  ///< indices, with the loop itself
  std::vector<size_t> rivals;   ///< waiting loops that contradict it from nearby
  std::set<KeyframeId> keyframes, rival_keyframes;
  std::vector<RelativeScale> scales;

  [[nodiscard]] bool is_ambiguous() const {
    return !rival_keyframes.empty() && keyframes.size() < rival_keyframes.size() + kLead;
  }
};

Group group_of(size_t index, const std::vector<LoopVerificationResult>& waiting, const Map& map) {
  constexpr double kNearby_m = 3;  // along the path: of the same visit
  const LoopClosure& x = waiting[index].loop;
  const EndDistances distances(map, x);
  Group group;
  const auto take = [&](const LoopClosure& y) {
    group.keyframes.insert(y.b);
    group.scales.push_back(directed_as(x, y, map)->evidence.scale);
  };
  for (size_t i = 0; i < waiting.size(); ++i) {
    const LoopClosure& y = waiting[i].loop;
    const LoopRelation relation = i == index ? LoopRelation::kAgree : relate(map, x, distances, y);
    if (relation == LoopRelation::kAgree) {
      group.waiting.push_back(i);
      take(y);
    } else if (relation == LoopRelation::kContradict &&
               std::min(distances.from_a_m[y.b.value], distances.from_b_m[y.b.value]) < kNearby_m) {
      group.rivals.push_back(i);
      group.rival_keyframes.insert(y.b);
    }
  }
  for (const LoopClosure& y : map.loop_closures()) {
    if (distances.from_b_m[y.b.value] < kNearby_m && relate(map, x, distances, y) == LoopRelation::kAgree)
      take(y);
  }
  return group;
}

bool is_usable(const Map& map, const LoopClosure& loop) {
  return !map.keyframe(loop.a).withdrawn && !map.keyframe(loop.b).withdrawn;
}

bool joins_components(const Map& map, const LoopClosure& loop) {
  return map.keyframe(loop.a).component != map.keyframe(loop.b).component;
}

LoopClosure as(LoopClosure loop, LoopStage stage, LoopReason reason) {
  loop.stage = stage;
  loop.reason = reason;
  return loop;
}

}  // namespace

LoopRelation relate(const Map& map, const LoopClosure& x, const LoopClosure& y) {
  return relate(map, x, EndDistances(map, x), y);
}

bool fits_map(const Map& map, const LoopClosure& loop) {
  constexpr double kMaxBend_m = 0.1, kMaxBend_rad = 0.05;
  const Keyframe &a = map.keyframe(loop.a), &b = map.keyframe(loop.b);
  if (a.component != b.component) return false;
  const SE3 error = (a.T_world_camera.inverse() * b.T_world_camera).inverse() * loop.T_a_b;
  return error.translation.norm() < kMaxBend_m && error.angle_rad() < kMaxBend_rad;
}

LoopDecisions LoopHypotheses::add(const Map& map, std::vector<LoopVerificationResult> verified,
                                  const Sensor& sensor) {
  std::erase_if(waiting_, [&](const auto& waiting) { return !is_usable(map, waiting.loop); });
  const size_t first = waiting_.size();
  for (LoopVerificationResult& result : verified) {
    if (is_usable(map, result.loop)) waiting_.push_back(std::move(result));
  }
  return decide(first, {map, sensor, kAgreeingKeyframes, kViewsOfSuspect});
}

LoopDecisions LoopHypotheses::finish(const Map& map, const Sensor& sensor) {
  std::erase_if(waiting_, [&](const auto& waiting) { return !is_usable(map, waiting.loop); });
  return decide(0, {map, sensor, kAgreeingKeyframesAtEnd, kViewsOfSuspectAtEnd});
}

/// What refutes a group of loops with these scales, although they agree; kNone if nothing does.
LoopReason LoopHypotheses::refute(size_t index, const std::vector<RelativeScale>& scales, const Map& map,
                                  const CompareRooms& compare_rooms) const {
  const LoopClosure& loop = waiting_[index].loop;
  if (refutes_same_place(combine(scales))) return LoopReason::kScale;
  if (!joins_components(map, loop)) return LoopReason::kNone;
  if (is_out_of_reach(loop, map)) return LoopReason::kDoesNotFit;
  const RoomComparison& rooms = compare_rooms();
  if (rooms.looks.refute_same_place()) return LoopReason::kLooksDifferent;
  return refutes_same_room(rooms) ? LoopReason::kDoesNotFit : LoopReason::kNone;
}

/// Whether a loop would place the beginning of one component where the camera cannot have moved from the
/// other in time.
bool LoopHypotheses::is_out_of_reach(const LoopClosure& loop, const Map& map) const {
  constexpr double kDriftPerMetre = 0.03;  // as in cycle_bound
  const auto is_beyond = [&](const LoopClosure& l, const Beginning& beginning) {
    const auto& [first_id, before] = beginning;
    const Keyframe& first = map.keyframe(first_id);
    const uint32_t from = map.keyframe(before.reference).component;
    if (first.component != map.keyframe(l.b).component || from != map.keyframe(l.a).component) return false;
    const double travelled_m = travelled_distances(map, l.a)[before.reference.value];
    if (!std::isfinite(travelled_m)) return false;
    const Eigen::Vector3d p_world_a = T_world_a_world_b(map, l) * first.T_world_camera.translation;
    return !can_reach(before, map, p_world_a, first.stamp_ns, kDriftPerMetre * travelled_m);
  };
  return std::any_of(beginnings_.begin(), beginnings_.end(), [&](const Beginning& beginning) {
    return is_beyond(loop, beginning) || is_beyond(inverse(loop), beginning);
  });
}

bool LoopHypotheses::has_double(const Map& map, KeyframeId keyframe) {
  const auto [found, added] = doubles_.try_emplace(keyframe, false);
  if (added) found->second = has_double_(map, keyframe);
  return found->second;
}

/// Whether a loop would join components although too few keyframes of its group show places without doubles.
bool LoopHypotheses::joins_by_doubles(size_t index, const std::vector<size_t>& group,
                                      const Situation& situation) {
  const Map& map = situation.map;
  const LoopClosure& loop = waiting_[index].loop;
  if (!joins_components(map, loop)) return false;
  std::set<KeyframeId> distinct;
  for (const size_t member : group) {
    const LoopClosure& other = waiting_[member].loop;
    if (!has_double(map, other.a) && !has_double(map, other.b)) distinct.insert(other.b);
  }
  return static_cast<int>(distinct.size()) < situation.required_keyframes;
}

/// Whether a loop joins a component in which the camera was falsely located, or two that a group of loops
/// falsely joined before, after too few views.
bool LoopHypotheses::joins_suspect_early(size_t index, const Situation& situation,
                                         const CompareRooms& compare_rooms) const {
  const Map& map = situation.map;
  const LoopClosure& loop = waiting_[index].loop;
  const uint32_t a = map.keyframe(loop.a).component, b = map.keyframe(loop.b).component;
  const auto component = [&](KeyframeId id) { return map.keyframe(id).component; };
  const bool suspected =
      std::any_of(suspected_.begin(), suspected_.end(),
                  [&](KeyframeId place) { return component(place) == a || component(place) == b; }) ||
      std::any_of(refuted_.begin(), refuted_.end(), [&](const LoopEnds& ends) {
        const uint32_t c = component(ends.a), d = component(ends.b);
        return (c == a && d == b) || (c == b && d == a);
      });
  return joins_components(map, loop) && suspected &&
         compare_rooms().looks.views < situation.required_views_of_suspect;
}

/// Decides on the waiting loops from index `first` on.
LoopDecisions LoopHypotheses::decide(size_t first, const Situation& situation) {
  const Map& map = situation.map;
  LoopDecisions decisions;
  std::vector<bool> decided(waiting_.size(), false);
  const auto reject = [&](size_t i, LoopReason reason) {
    if (decided[i]) return;
    decided[i] = true;
    decisions.others.push_back(as(waiting_[i].loop, LoopStage::kRejected, reason));
  };
  for (size_t i = first; i < waiting_.size(); ++i) {
    if (decided[i]) continue;
    LoopClosure& loop = waiting_[i].loop;
    const Group group = group_of(i, waiting_, map);
    std::optional<RoomComparison> compared;  // at most once, since it takes long
    const CompareRooms compare_rooms = [&]() -> const RoomComparison& {
      if (!compared) compared = compare_components(map, loop, situation.sensor);
      return *compared;
    };
    loop.support = static_cast<int>(group.keyframes.size());
    const bool alone = fits_map(map, loop);
    const bool too_few = !alone && (loop.support < situation.required_keyframes ||
                                    joins_suspect_early(i, situation, compare_rooms));
    if (group.is_ambiguous() || (!too_few && joins_by_doubles(i, group.waiting, situation))) {
      decisions.others.push_back(as(loop, LoopStage::kProvisional, LoopReason::kAmbiguous));
    } else if (too_few) {
      decisions.others.push_back(as(loop, LoopStage::kProvisional, LoopReason::kTooFewKeyframes));
    } else if (const LoopReason reason = refute(i, group.scales, map, compare_rooms);
               reason != LoopReason::kNone) {
      for (const size_t member : group.waiting) reject(member, reason);
      if (reason != LoopReason::kScale) refuted_.push_back(loop.ends());
    } else {
      for (const size_t member : group.waiting) {
        if (decided[member]) continue;
        decided[member] = true;
        waiting_[member].loop.support = loop.support;
        waiting_[member].loop.reason = alone ? LoopReason::kFitsMap : LoopReason::kKeyframesAgree;
        decisions.accepted.push_back(waiting_[member]);
      }
      for (const size_t rival : group.rivals) reject(rival, LoopReason::kDoesNotFit);
    }
  }
  size_t index = 0;
  std::erase_if(waiting_, [&](const auto&) { return decided[index++]; });
  return decisions;
}

}  // namespace kinloop
