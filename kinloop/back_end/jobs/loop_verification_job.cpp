#include "kinloop/back_end/jobs/loop_jobs.hpp"

namespace kinloop {

void LoopVerificationJob::add(LoopVerificationProblem hypotheses) {
  if (!hypotheses.candidates.empty()) waiting_.push_back(std::move(hypotheses));
}

LoopVerificationJob::Solution LoopVerificationJob::solve(const Problem& problem) {
  Solution loops;
  for (const LoopVerificationProblem& keyframe : problem.keyframes)
    loops.push_back(verify_loops(keyframe, problem.context));
  return loops;
}

}  // namespace kinloop
