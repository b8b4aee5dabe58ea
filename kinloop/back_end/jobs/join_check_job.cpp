#include "kinloop/back_end/jobs/join_check_job.hpp"

namespace kinloop {
namespace {

constexpr int kMinViews = 10, kMinViewsAtEnd = 4;

}  // namespace

JoinCheckJob::Solution JoinCheckJob::solve(const Problem& problem) {
  Solution looks;
  for (const JoinedViews& views : problem.views) looks.push_back(compare(views, problem.sensor));
  return looks;
}

std::optional<AppliedSolution> JoinCheckJob::apply(Map& map, const Solution& looks) {
  joins_.add(looks);
  return part(map, kMinViews);
}

AppliedSolution JoinCheckJob::finish(Map& map) {
  return part(map, kMinViewsAtEnd);
}

/// Withdraws the loop closures of refuted joins.
AppliedSolution JoinCheckJob::part(Map& map, int min_views) {
  AppliedSolution applied{.map_changed = false};
  applied.refuted_joins = joins_.take_refuted(map, min_views);
  if (applied.refuted_joins.empty()) return applied;
  applied.T_world_keyframe_before = map.withdraw_loops(applied.refuted_joins, LoopReason::kLooksDifferent);
  map.advance_epoch();  // work in flight has the visits in one part
  applied.map_changed = applied.loops_corrected = true;
  return applied;
}

}  // namespace kinloop
