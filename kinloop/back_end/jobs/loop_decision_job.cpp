#include "kinloop/back_end/jobs/loop_jobs.hpp"

namespace kinloop {
namespace {

/// Adds the accepted loops to the map and remembers the others.
void carry_out(const LoopDecisions& decisions, Map& map, AppliedSolution& applied) {
  for (const LoopVerificationResult& verified : decisions.accepted) {
    applied.map_changed = applied.loops_added = true;
    applied.merges.push_back({verified.loop.ends(), landmark_merges(map, verified)});
    map.add_loop_closure(verified.loop);
  }
  for (const LoopClosure& loop : decisions.others) map.record_loop(loop);
}

}  // namespace

AppliedSolution LoopDecisionJob::add(Map& map, const VerifiedLoops& verified) {
  AppliedSolution applied{.map_changed = false};
  for (const auto& of_keyframe : verified) {
    if (!of_keyframe.empty()) carry_out(hypotheses_.add(map, of_keyframe), map, applied);
  }
  return applied;
}

std::optional<AppliedSolution> LoopDecisionJob::apply(Map& map, const Solution& compared) {
  if (compared.epoch != map.epoch()) return std::nullopt;
  AppliedSolution applied{.map_changed = false};
  carry_out(hypotheses_.decide(map, compared), map, applied);
  return applied;
}

AppliedSolution LoopDecisionJob::finish(Map& map) {
  AppliedSolution applied{.map_changed = false};
  carry_out(hypotheses_.finish(map), map, applied);
  return applied;
}

}  // namespace kinloop
