#include "kinloop/back_end/jobs/loop_jobs.hpp"

namespace kinloop {
namespace {

constexpr int kMinViews = 10, kMinViewsAtEnd = 4;

}  // namespace

JoinCheckJob::Solution JoinCheckJob::solve(const Problem& problem) {
  Solution results;
  for (const OverlappingViews& views : problem.views)
    results.push_back(compare_joined(views, problem.sensor));
  return results;
}

std::optional<AppliedSolution> JoinCheckJob::apply(Map& map, const Solution& results) {
  joins_.add(results);
  return part(map, kMinViews);
}

AppliedSolution JoinCheckJob::finish(Map& map) {
  return part(map, kMinViewsAtEnd);
}

/// Withdraws the loop closures of contradicted joins.
AppliedSolution JoinCheckJob::part(Map& map, int min_views) {
  AppliedSolution applied{.map_changed = false};
  applied.contradicted_joins = joins_.take_contradicted(map, min_views);
  if (applied.contradicted_joins.empty()) return applied;
  applied.T_world_keyframe_before = map.withdraw_loops(applied.contradicted_joins, LoopReason::kAppearance);
  map.advance_epoch();  // work in flight has the visits in one part
  applied.map_changed = applied.loops_corrected = true;
  return applied;
}

}  // namespace kinloop
