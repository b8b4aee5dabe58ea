#include <algorithm>
#include <iterator>

#include "kinloop/loop/recognition/candidates.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"

namespace kinloop {
namespace {

/// The hypotheses that `place` is seen by the keyframes around `end`, where T_place_end was measured.
std::vector<LoopVerificationProblem> hypotheses_around(const Map& map, KeyframeId place, KeyframeId end,
                                                       const SE3& T_place_end,
                                                       const LocalMapOptions& options) {
  std::vector<LoopVerificationProblem> problems;
  const LocalMap local_map = make_local_map(map, place, options);
  const SE3 T_end_world = map.keyframe(end).T_world_camera.inverse();
  for (const KeyframeId neighbour : covisible_group(map, end)) {
    if (neighbour == end) continue;
    const SE3 T_end_neighbour = T_end_world * map.keyframe(neighbour).T_world_camera;
    LoopVerificationProblem problem = make_loop_verification_problem(map.keyframe(neighbour));
    const LoopClosure hypothesis{
        .a = place, .b = neighbour, .T_a_b = T_place_end * T_end_neighbour, .support = 2};
    problem.candidates.push_back({hypothesis, std::nullopt, local_map});
    problems.push_back(std::move(problem));
  }
  return problems;
}

}  // namespace

std::vector<LoopVerificationProblem> seek_support(const Map& map, const LoopClosure& loop,
                                                  const LocalMapOptions& options) {
  auto problems = hypotheses_around(map, loop.a, loop.b, loop.T_a_b, options);
  auto others = hypotheses_around(map, loop.b, loop.a, loop.T_a_b.inverse(), options);
  std::move(others.begin(), others.end(), std::back_inserter(problems));
  return problems;
}

}  // namespace kinloop
