#include "kinloop/back_end/jobs/loop_verification_job.hpp"

#include <utility>

namespace kinloop {

void LoopVerificationJob::add(LoopVerificationProblem hypotheses) {
  if (!hypotheses.candidates.empty()) waiting_.push_back(std::move(hypotheses));
}

bool LoopVerificationJob::is_due(const JobContext& /*context*/) const {
  return !waiting_.empty();
}

LoopVerificationJob::Problem LoopVerificationJob::make_problem(const JobContext& context) {
  return {std::exchange(waiting_, {}), {context.sensor, options_}};
}

LoopVerificationJob::Solution LoopVerificationJob::solve(const Problem& problem) {
  Solution loops;
  for (const LoopVerificationProblem& keyframe : problem.keyframes) {
    auto verified = verify_loop(keyframe, problem.context);
    if (verified) loops.push_back(std::move(*verified));
  }
  return loops;
}

std::optional<AppliedSolution> LoopVerificationJob::apply(Map& map, const Solution& loops) {
  AppliedSolution applied;
  for (const LoopVerificationResult& verified : loops) {
    if (map.keyframe(verified.loop.a).withdrawn || map.keyframe(verified.loop.b).withdrawn) continue;
    applied.map_changed = applied.loops_added = true;
    const LandmarkMerges merges = landmark_merges(map, verified);
    applied.merges.insert(applied.merges.end(), merges.begin(), merges.end());
    map.add_loop_closure(verified.loop);
  }
  return applied;
}

}  // namespace kinloop
