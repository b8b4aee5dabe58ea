// A pose graph solved again and again as it grows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/optimize/pose_graph_world.hpp"

namespace kinloop {
namespace {

using test::largest_difference;
using test::make_loop_world;

/// The first `count` vertices with the edges among them.
template <class Pose>
BasicPoseGraph<Pose> beginning(const BasicPoseGraph<Pose>& graph, uint32_t count) {
  BasicPoseGraph<Pose> part;
  part.T_world_vertex.assign(graph.T_world_vertex.begin(), graph.T_world_vertex.begin() + count);
  for (const auto& edge : graph.edges) {
    if (edge.a < count && edge.b < count) part.edges.push_back(edge);
  }
  return part;
}

template <class Pose>
void expect_grown_equals_batch(const PoseGraphOptions& options) {
  const auto world = make_loop_world<Pose>({.rounds = 6, .sigma = 0.02}, 20);
  const auto all = static_cast<uint32_t>(world.truth.size());
  auto grown = solve_pose_graph(beginning(world.graph, 30), options);
  for (uint32_t count = 37; count < all + 7; count += 7) {  // with and without loop closings in between
    const auto graph = beginning(world.graph, std::min(count, all));
    grown = update_pose_graph_solution(graph, grown, options);
    const auto batch = solve_pose_graph(graph, options);
    EXPECT_NEAR(grown.chi2_after, batch.chi2_after, 1e-6 * batch.chi2_after) << count;
    EXPECT_LT(largest_difference(grown.T_world_vertex, batch.T_world_vertex), 1e-3) << count;
    EXPECT_DOUBLE_EQ(grown.chi2_before, batch.chi2_before);
  }
}

TEST(GrownPoseGraph, HasTheMinimumOfTheBatchSolutionWhateverTheSolver) {
  for (const auto solver : {PoseGraphSolver::kBuiltin, PoseGraphSolver::kCeres, PoseGraphSolver::kG2o}) {
    if (!pose_graph_solver_available(solver)) continue;
    PoseGraphOptions options;
    options.solver = solver;
    expect_grown_equals_batch<SE3>(options);
    expect_grown_equals_batch<SE2>(options);
  }
}

TEST(GrownPoseGraph, KeepsTheOrderOfEliminationWithNewVerticesLast) {
  const auto world = make_loop_world<SE2>({.rounds = 6}, 21);
  const auto first = solve_pose_graph(beginning(world.graph, 100));
  const auto second = update_pose_graph_solution(beginning(world.graph, 101), first);
  ASSERT_EQ(second.elimination.vertices.size(), first.elimination.vertices.size() + 1);
  auto expected = first.elimination.vertices;
  expected.push_back(100);
  EXPECT_EQ(second.elimination.vertices, expected);
  EXPECT_EQ(second.elimination.planned_products, first.elimination.planned_products);
  const auto last = update_pose_graph_solution(world.graph, solve_pose_graph(beginning(world.graph, 5)));
  EXPECT_EQ(last.elimination.vertices, solve_pose_graph(world.graph).elimination.vertices)
      << "much has come since: chosen afresh";
}

TEST(GrownPoseGraph, HandlesNewComponentsAndReleasedVertices) {
  auto world = make_loop_world<SE3>({.sigma = 0}, 22);
  PoseGraph apart = world.graph;  // 30 to 59 are a part of their own at first
  std::erase_if(apart.edges, [](const auto& edge) { return edge.a < 30 && edge.b >= 30; });
  ASSERT_EQ(count_connected_components(apart), 2U);
  const auto solution = update_pose_graph_solution(world.graph, solve_pose_graph(apart));
  EXPECT_LT(largest_difference(solution.T_world_vertex, world.truth), 1e-5);
}

TEST(GrownPoseGraph, MayNotHaveShrunk) {
  const auto world = make_loop_world<SE3>({}, 23);
  const auto whole = solve_pose_graph(world.graph);
  EXPECT_THROW(update_pose_graph_solution(beginning(world.graph, 10), whole), std::logic_error);
}

}  // namespace
}  // namespace kinloop
