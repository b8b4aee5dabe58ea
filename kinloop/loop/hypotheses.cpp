#include "kinloop/loop/hypotheses.hpp"

#include <algorithm>
#include <set>

#include "kinloop/loop/verification/compare_visits.hpp"
#include "kinloop/loop/verification/relative_scale.hpp"

namespace kinloop {
namespace {

constexpr size_t kLead = 2;  // keyframes more than those of a place that contradicts

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

/// The poses of all keyframes relative to the ends of a loop.
struct EndPoses {
  RelativePoses of_a, of_b;

  EndPoses(const Map& map, const LoopClosure& loop) : of_a(map, loop.a), of_b(map, loop.b) {}
};

LoopRelation relate(const Map& map, const LoopClosure& x, const EndPoses& poses, const LoopClosure& other) {
  const auto y = directed_as(x, other, map);
  if (!y) return LoopRelation::kUnknown;
  const auto a = poses.of_a.pose_of(y->a), b = poses.of_b.pose_of(y->b);
  if (!a || !b) return LoopRelation::kUnknown;
  PredictedView by_x = measured_view(x) * *b;
  const PredictedView by_y = *a * measured_view(*y);
  by_x.covariance += by_y.covariance;
  if (!is_explained(by_x, by_y.T_reference_camera)) return LoopRelation::kContradict;
  // Where the cycle is uncertain, false loops agree as well.
  constexpr double kMaxSigma_m = 0.06;
  return expected_error(by_x.covariance).translation_m <= kMaxSigma_m ? LoopRelation::kAgree
                                                                      : LoopRelation::kUnknown;
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
  return relate(map, x, EndPoses(map, x), y);
}

bool fits_map(const Map& map, const LoopClosure& loop) {
  constexpr double kMaxBend_m = 0.1, kMaxBend_rad = 0.05;
  const Keyframe &a = map.keyframe(loop.a), &b = map.keyframe(loop.b);
  if (a.component != b.component) return false;
  const SE3 error = (a.T_world_camera.inverse() * b.T_world_camera).inverse() * loop.T_a_b;
  return error.translation.norm() < kMaxBend_m && error.angle_rad() < kMaxBend_rad;
}

const LoopHypotheses::Requirements LoopHypotheses::kDuringRun{3, 20}, LoopHypotheses::kAtEnd{2, 4};

/// The loops that agree with one, and how many keyframes support and contradict it.
struct LoopHypotheses::Group {
  std::vector<size_t> waiting;  ///< indices, with the loop itself
  std::vector<size_t> rivals;   ///< waiting loops that contradict it from nearby
  std::set<KeyframeId> keyframes, rival_keyframes;
  std::vector<RelativeScale> scales;

  [[nodiscard]] bool is_ambiguous() const {
    return !rival_keyframes.empty() && keyframes.size() < rival_keyframes.size() + kLead;
  }
};

/// What becomes of a loop, or of its group if that is accepted or rejected.
struct LoopHypotheses::Decision {
  LoopStage stage;
  LoopReason reason;
};

LoopDecisions LoopHypotheses::add(const Map& map, std::vector<LoopVerificationResult> verified) {
  required_ = kDuringRun;
  for (LoopVerificationResult& result : verified) waiting_.push_back({std::move(result)});
  return decide(map);
}

LoopDecisions LoopHypotheses::finish(const Map& map) {
  required_ = kAtEnd;
  for (Waiting& waiting : waiting_) waiting.state = State::kUndecided;
  return decide(map);
}

LoopDecisions LoopHypotheses::decide(const Map& map, const ComparedJoins& compared) {
  rooms_ = compared.rooms;
  appearances_ = compared.cache;
  LoopDecisions decisions = decide(map);
  rooms_.clear();                                      // later there will be more views
  if (!decisions.accepted.empty()) appearances_ = {};  // of components that are one now
  return decisions;
}

JoinProblem LoopHypotheses::join_problem(const Map& map, const Sensor& sensor) const {
  JoinProblem problem{
      .joins = {}, .views = {}, .cache = appearances_, .sensor = sensor, .epoch = map.epoch()};
  for (const LoopClosure& loop : asked_)
    problem.joins.push_back({loop, needs_more_views(loop, map) ? required_.views_if_doubted : 0});
  for (const Keyframe& keyframe : map.keyframes()) problem.views.push_back(view_of(keyframe));
  return problem;
}

void LoopHypotheses::forget_withdrawn(const Map& map) {
  std::erase_if(waiting_, [&](const Waiting& waiting) { return !is_usable(map, waiting.verified.loop); });
}

LoopHypotheses::Group LoopHypotheses::group_of(size_t index, const Map& map) const {
  constexpr double kNearby_m = 3;  // along the path: of the same visit
  const LoopClosure& x = waiting_[index].verified.loop;
  const EndPoses poses(map, x);
  Group group;
  const auto take = [&](const LoopClosure& y) {
    group.keyframes.insert(y.b);
    group.scales.push_back(directed_as(x, y, map)->evidence.scale);
  };
  for (size_t i = 0; i < waiting_.size(); ++i) {
    const LoopClosure& y = waiting_[i].verified.loop;
    const LoopRelation relation = i == index ? LoopRelation::kAgree : relate(map, x, poses, y);
    if (relation == LoopRelation::kAgree) {
      group.waiting.push_back(i);
      take(y);
    } else if (relation == LoopRelation::kContradict &&
               std::min(poses.of_a.path_length_m(y.b), poses.of_b.path_length_m(y.b)) < kNearby_m) {
      group.rivals.push_back(i);
      group.rival_keyframes.insert(y.b);
    }
  }
  for (const LoopClosure& y : map.loop_closures()) {
    if (poses.of_b.path_length_m(y.b) < kNearby_m && relate(map, x, poses, y) == LoopRelation::kAgree)
      take(y);
  }
  return group;
}

/// What the views say of a group; null if they have not been compared.
const RoomComparison* LoopHypotheses::rooms_of(const Group& group) const {
  for (const size_t member : group.waiting) {
    const auto found = rooms_.find(waiting_[member].verified.loop.ends());
    if (found != rooms_.end()) return &found->second;
  }
  return nullptr;
}

/// Whether a loop would place the beginning of one component where the camera cannot have moved from the
/// other in time.
bool LoopHypotheses::is_out_of_reach(const LoopClosure& loop, const Map& map) const {
  const auto is_beyond = [&](const LoopClosure& l, const Beginning& beginning) {
    const auto& [first_id, before] = beginning;
    const Keyframe& first = map.keyframe(first_id);
    const uint32_t from = map.keyframe(before.pose.reference).component;
    if (first.component != map.keyframe(l.b).component || from != map.keyframe(l.a).component) return false;
    const auto predicted = RelativePoses(map, l.a).pose_of(before.pose.reference);
    if (!predicted) return false;
    const Eigen::Vector3d p_world_a =
        T_world_a_world_b(l, map.keyframe(l.a).T_world_camera, map.keyframe(l.b).T_world_camera) *
        first.T_world_camera.translation;
    return !can_reach(before, map, p_world_a, first.stamp_ns,
                      largest_error(predicted->covariance).translation_m);
  };
  return std::any_of(beginnings_.begin(), beginnings_.end(), [&](const Beginning& beginning) {
    return is_beyond(loop, beginning) || is_beyond(inverse(loop), beginning);
  });
}

/// Whether too few keyframes of a group show places that are not aliased.
bool LoopHypotheses::joins_aliased_places(const Group& group, const Map& map) const {
  std::set<KeyframeId> distinct;
  for (const size_t member : group.waiting) {
    const LoopClosure& loop = waiting_[member].verified.loop;
    if (!is_aliased_(map, loop.a) && !is_aliased_(map, loop.b)) distinct.insert(loop.b);
    if (static_cast<int>(distinct.size()) >= required_.keyframes) return false;
  }
  return true;
}

/// Whether a loop joins a component in which the camera was falsely located, or two that a group of loops
/// falsely joined before.
bool LoopHypotheses::needs_more_views(const LoopClosure& loop, const Map& map) const {
  const auto component = [&](KeyframeId id) { return map.keyframe(id).component; };
  const uint32_t a = component(loop.a), b = component(loop.b);
  return std::any_of(more_evidence_needed_.begin(), more_evidence_needed_.end(),
                     [&](KeyframeId place) { return component(place) == a || component(place) == b; }) ||
         std::any_of(contradicted_.begin(), contradicted_.end(), [&](const LoopEnds& ends) {
           const uint32_t c = component(ends.a), d = component(ends.b);
           return (c == a && d == b) || (c == b && d == a);
         });
}

/// Judges a loop; nullopt if views must be compared first.
std::optional<LoopHypotheses::Decision> LoopHypotheses::judge(const LoopClosure& loop, const Group& group,
                                                              const Map& map) {
  const bool alone = fits_map(map, loop);
  if (group.is_ambiguous()) return Decision{LoopStage::kProvisional, LoopReason::kAmbiguous};
  if (!alone && loop.support < required_.keyframes)
    return Decision{LoopStage::kProvisional, LoopReason::kTooFewKeyframes};
  if (joins_components(map, loop)) return judge_join(loop, group, map);
  if (contradicts_same_place(combine(group.scales)))
    return Decision{LoopStage::kRejected, LoopReason::kScale};
  return Decision{LoopStage::kVerified, alone ? LoopReason::kFitsMap : LoopReason::kKeyframesAgree};
}

/// Judges a loop that joins components and that enough keyframes support.
std::optional<LoopHypotheses::Decision> LoopHypotheses::judge_join(const LoopClosure& loop,
                                                                   const Group& group, const Map& map) {
  const RoomComparison* rooms = rooms_of(group);
  if (needs_more_views(loop, map)) {
    if (rooms == nullptr) return std::nullopt;
    if (rooms->appearance.views < required_.views_if_doubted)
      return Decision{LoopStage::kProvisional, LoopReason::kTooFewKeyframes};
  }
  if (joins_aliased_places(group, map)) return Decision{LoopStage::kProvisional, LoopReason::kAmbiguous};
  if (contradicts_same_place(combine(group.scales)))
    return Decision{LoopStage::kRejected, LoopReason::kScale};
  if (is_out_of_reach(loop, map)) return Decision{LoopStage::kRejected, LoopReason::kDoesNotFit};
  if (rooms == nullptr) return std::nullopt;
  if (rooms->appearance.contradicts_same_place())
    return Decision{LoopStage::kRejected, LoopReason::kAppearance};
  if (contradicts_same_room(*rooms)) return Decision{LoopStage::kRejected, LoopReason::kDoesNotFit};
  return Decision{LoopStage::kVerified, LoopReason::kKeyframesAgree};
}

/// Decides on the waiting loops that are not provisional yet.
LoopDecisions LoopHypotheses::decide(const Map& map) {
  forget_withdrawn(map);
  asked_.clear();
  for (Waiting& waiting : waiting_) {
    if (waiting.state == State::kAsking) waiting.state = State::kUndecided;
  }
  LoopDecisions decisions;
  for (size_t i = 0; i < waiting_.size(); ++i) {
    if (waiting_[i].state != State::kUndecided) continue;
    const Group group = group_of(i, map);
    LoopClosure& loop = waiting_[i].verified.loop;
    loop.support = static_cast<int>(group.keyframes.size());
    const auto decision = judge(loop, group, map);
    if (!decision) {
      ask(loop, group);
    } else if (decision->stage == LoopStage::kVerified) {
      accept(loop, group, decision->reason, decisions);
    } else if (decision->stage == LoopStage::kRejected) {
      reject(group.waiting, decision->reason, decisions);
      if (decision->reason != LoopReason::kScale) contradicted_.push_back(loop.ends());
    } else {
      waiting_[i].state = State::kProvisional;
      decisions.others.push_back(as(loop, decision->stage, decision->reason));
    }
  }
  std::erase_if(waiting_, [](const Waiting& waiting) { return waiting.state == State::kDecided; });
  return decisions;
}

/// Has one loop of a group compared, for all.
void LoopHypotheses::ask(const LoopClosure& loop, const Group& group) {
  asked_.push_back(loop);
  for (const size_t member : group.waiting) {
    State& state = waiting_[member].state;
    if (state == State::kUndecided) state = State::kAsking;
  }
}

void LoopHypotheses::accept(const LoopClosure& loop, const Group& group, LoopReason reason,
                            LoopDecisions& decisions) {
  for (const size_t member : group.waiting) {
    Waiting& waiting = waiting_[member];
    if (waiting.state == State::kDecided) continue;
    waiting.state = State::kDecided;
    waiting.verified.loop.support = loop.support;
    waiting.verified.loop.reason = reason;
    decisions.accepted.push_back(waiting.verified);
  }
  reject(group.rivals, LoopReason::kDoesNotFit, decisions);
}

void LoopHypotheses::reject(const std::vector<size_t>& loops, LoopReason reason, LoopDecisions& decisions) {
  for (const size_t i : loops) {
    Waiting& waiting = waiting_[i];
    if (waiting.state == State::kDecided) continue;
    waiting.state = State::kDecided;
    decisions.others.push_back(as(waiting.verified.loop, LoopStage::kRejected, reason));
  }
}

}  // namespace kinloop
