#include "kinloop/back_end/jobs/loop_verification_job.hpp"

#include <utility>

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

void LoopVerificationJob::add(LoopVerificationProblem hypotheses) {
  if (!hypotheses.candidates.empty()) waiting_.push_back(std::move(hypotheses));
}

bool LoopVerificationJob::is_due(const JobContext& /*context*/) const {
  return !waiting_.empty();
}

LoopVerificationJob::Problem LoopVerificationJob::make_problem(const JobContext& context) {
  sensor_ = context.sensor;
  return {std::exchange(waiting_, {}), {context.sensor, options_}};
}

LoopVerificationJob::Solution LoopVerificationJob::solve(const Problem& problem) {
  Solution loops;
  for (const LoopVerificationProblem& keyframe : problem.keyframes)
    loops.push_back(verify_loops(keyframe, problem.context));
  return loops;
}

std::optional<AppliedSolution> LoopVerificationJob::apply(Map& map, const Solution& loops) {
  AppliedSolution applied{.map_changed = false};
  for (const auto& of_keyframe : loops) {
    if (!of_keyframe.empty()) carry_out(hypotheses_.add(map, of_keyframe, *sensor_), map, applied);
  }
  return applied;
}

AppliedSolution LoopVerificationJob::finish(Map& map) {
  AppliedSolution applied{.map_changed = false};
  if (sensor_) carry_out(hypotheses_.finish(map, *sensor_), map, applied);
  return applied;
}

}  // namespace kinloop
