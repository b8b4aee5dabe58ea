#include "kinloop/back_end/loop_verification_job.hpp"

#include <utility>

namespace kinloop {

void LoopVerificationJob::add(LoopCandidates candidates) {
  if (!candidates.places.empty()) waiting_.push_back(std::move(candidates));
}

bool LoopVerificationJob::is_due(const JobContext& /*context*/) const {
  return !waiting_.empty();
}

LoopVerificationJob::Problem LoopVerificationJob::make_problem(const JobContext& context) {
  return {std::exchange(waiting_, {}), context.sensor, loop_, tracking_};
}

std::vector<VerifiedLoop> LoopVerificationJob::solve(const Problem& problem) {
  std::vector<VerifiedLoop> loops;
  for (const LoopCandidates& candidates : problem.candidates) {
    auto loop = verify_loop(candidates, problem.sensor, problem.loop, problem.tracking);
    if (loop) loops.push_back(std::move(*loop));
  }
  return loops;
}

std::optional<AppliedSolution> LoopVerificationJob::apply(Map& map, const Solution& loops) const {
  AppliedSolution applied;
  applied.map_changed = !loops.empty();
  for (const VerifiedLoop& loop : loops) {
    LoopConstraint constraint = make_loop_constraint(map, loop, loop_);
    map.add_loop_edge(constraint.edge);
    applied.loops.push_back(std::move(constraint));
  }
  return applied;
}

}  // namespace kinloop
