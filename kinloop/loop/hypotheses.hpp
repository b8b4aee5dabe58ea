#pragma once
// Decides which verified loops become edges of the map. One pair of keyframes may look alike by chance; that
// several keyframes of a visit measure the same relative pose to another visit is no chance. Until then the
// map is not bent.

#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "kinloop/belief/reach.hpp"
#include "kinloop/loop/verification/compare_visits.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// Whether two loops place one visit at the same pose relative to another.
enum class LoopRelation {
  kUnknown,     ///< too much drift lies between them, or they join other components
  kAgree,       ///< within their covariances and the drift between their keyframes
  kContradict,  ///< one of them is false
};

/// Compares two loops by the cycle along both and the map between their ends (pairwise consistency, Mangelson
/// et al. 2018).
LoopRelation relate(const Map& map, const LoopClosure& x, const LoopClosure& y);

/// Returns whether the map predicts the measured pose within 10 cm and .05 rad, so that little bends.
bool fits_map(const Map& map, const LoopClosure& loop);

/// What has been decided.
struct LoopDecisions {
  std::vector<LoopVerificationResult> accepted;  ///< to be added to the map; still marked verified
  std::vector<LoopClosure> others;               ///< provisional or rejected, with the reason
};

/// Returns whether another place of the keyframe's component looks like that of the keyframe.
using IsAliased = std::function<bool(const Map& map, KeyframeId keyframe)>;

/// Verified loops that wait for other keyframes.
class LoopHypotheses {
 public:
  explicit LoopHypotheses(IsAliased is_aliased) : is_aliased_(std::move(is_aliased)) {}

  /// Adds the verified loops of one keyframe, and accepts what they complete: three keyframes that agree, or
  /// one loop that fits the map. Where places contradict each other, one must have two keyframes more. Loops
  /// whose visits differ in scale, or that join components whose surfaces contradict each other, are
  /// rejected, as those that join components although the camera cannot have moved from one to the other in
  /// time, and with a group those that contradict it. Two components are joined only after many of their
  /// views have been compared if a group between them was contradicted before. Loops between places that have
  /// doubles do not join components: along a corridor, all keyframes agree on the wrong one of the same
  /// doors.
  LoopDecisions add(const Map& map, std::vector<LoopVerificationResult> verified);

  /// Returns whether decisions wait until views have been compared. That takes long, so that it is left to a
  /// job.
  [[nodiscard]] bool needs_comparison() const { return !asked_.empty(); }

  /// Returns what must be compared.
  [[nodiscard]] JoinProblem join_problem(const Map& map, const Sensor& sensor) const;

  /// Decides with what the views say.
  LoopDecisions decide(const Map& map, const ComparedJoins& compared);

  /// Keeps what was compared in a map that has moved since, for the next comparison.
  void keep(AppearanceCache compared) { appearances_ = std::move(compared); }

  /// Says that the camera was thought to be in the component of this keyframe, and was not: a visit joins it
  /// only after many of its views have been compared.
  void require_more_evidence(KeyframeId place) { more_evidence_needed_.push_back(place); }

  /// Says that these loops falsely joined components, with the same effect.
  void record_contradicted(const std::vector<LoopEnds>& joins) {
    contradicted_.insert(contradicted_.end(), joins.begin(), joins.end());
  }

  /// Records the first keyframe of a component and the last trusted pose before it, in another one. Loops do
  /// not join them if the camera cannot have moved so far in the time between.
  void add_beginning(KeyframeId first, const CameraMotion& before) { beginnings_.push_back({first, before}); }

  /// Decides at the end of the run, when no further keyframes come: two that agree are enough. The others
  /// stay provisional, and wait for another run.
  LoopDecisions finish(const Map& map);

 private:
  enum class State {
    kUndecided,
    kAsking,       ///< it or one that agrees with it waits for a comparison
    kProvisional,  ///< waits for other keyframes
    kDecided
  };
  struct Waiting {
    LoopVerificationResult verified;
    State state = State::kUndecided;
  };
  struct Beginning {
    KeyframeId first;
    CameraMotion before;
  };
  struct Requirements {
    int keyframes, views_if_doubted;
  };
  struct Group;
  struct Decision;
  static const Requirements kDuringRun, kAtEnd;

  void forget_withdrawn(const Map& map);
  [[nodiscard]] Group group_of(size_t index, const Map& map) const;
  [[nodiscard]] const RoomComparison* rooms_of(const Group& group) const;
  [[nodiscard]] bool is_out_of_reach(const LoopClosure& loop, const Map& map) const;
  [[nodiscard]] bool joins_aliased_places(const Group& group, const Map& map) const;
  [[nodiscard]] bool needs_more_views(const LoopClosure& loop, const Map& map) const;
  [[nodiscard]] std::optional<Decision> judge(const LoopClosure& loop, const Group& group, const Map& map);
  [[nodiscard]] std::optional<Decision> judge_join(const LoopClosure& loop, const Group& group,
                                                   const Map& map);
  void ask(const LoopClosure& loop, const Group& group);
  void accept(const LoopClosure& loop, const Group& group, LoopReason reason, LoopDecisions& decisions);
  void reject(const std::vector<size_t>& loops, LoopReason reason, LoopDecisions& decisions);
  LoopDecisions decide(const Map& map);

  IsAliased is_aliased_;
  std::vector<KeyframeId> more_evidence_needed_;
  std::vector<Beginning> beginnings_;
  std::vector<LoopEnds> contradicted_;  // loops that would have joined components
  std::vector<Waiting> waiting_;
  Requirements required_ = kDuringRun;
  std::vector<LoopClosure> asked_;            // to be compared, one of each group
  std::map<LoopEnds, RoomComparison> rooms_;  // of those asked before
  AppearanceCache appearances_;
};

}  // namespace kinloop
