// Solvers compared with ground truth and with each other.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/optimize/pose_graph/chordal_initialization.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_structure.hpp"
#include "tests/optimize/pose_graph_world.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::largest_difference;
using test::make_loop_world;
using testing::HasSubstr;

PoseGraphOptions with_solver(PoseGraphSolver solver) {
  PoseGraphOptions options;
  options.solver = solver;
  return options;
}

class PoseGraphSolvers : public testing::TestWithParam<PoseGraphSolver> {
 protected:
  void SetUp() override {
    if (!pose_graph_solver_available(GetParam())) {
      GTEST_SKIP() << "this build has no " << name_of(GetParam()) << ": nothing to test";
    }
  }
  [[nodiscard]] static PoseGraphOptions options() { return with_solver(GetParam()); }
};

template <class Pose>
void expect_truth_without_noise(const PoseGraphOptions& options) {
  const auto world = make_loop_world<Pose>({.sigma = 0}, 1);
  const auto solution = solve_pose_graph(world.graph, options);
  EXPECT_LT(largest_difference(solution.T_world_vertex, world.truth), 1e-5);
  EXPECT_GT(solution.chi2_before, 1);
  EXPECT_LT(solution.chi2_after, 1e-8);
  EXPECT_DOUBLE_EQ(solution.chi2_before, chi2(world.graph));
}

TEST_P(PoseGraphSolvers, FindTheTruthWithoutNoise) {
  expect_truth_without_noise<SE3>(options());
  expect_truth_without_noise<SE2>(options());
}

template <class Pose>
void expect_consistent_with_noise(const PoseGraphOptions& options) {
  const auto world = make_loop_world<Pose>({.rounds = 5, .sigma = 0.003}, 2);
  const auto solution = solve_pose_graph(world.graph, options);
  BasicPoseGraph<Pose> truth = world.graph;
  truth.T_world_vertex = world.truth;
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(solution.chi2_after, chi2(truth)) << "the truth is a candidate, too";
  EXPECT_LT(largest_difference(solution.T_world_vertex, world.truth), 0.05);
}

TEST_P(PoseGraphSolvers, HaveSmallErrorsWithNoise) {
  expect_consistent_with_noise<SE3>(options());
  expect_consistent_with_noise<SE2>(options());
}

template <class Pose>
void expect_same_as_ceres(PoseGraphOptions options) {
  const auto world = make_loop_world<Pose>({.sigma = 0.05}, 3);
  const double expected = solve_pose_graph(world.graph, with_solver(PoseGraphSolver::kCeres)).chi2_after;
  for (const auto method :
       {PoseGraphMethod::kLevenberg, PoseGraphMethod::kGaussNewton, PoseGraphMethod::kDogleg}) {
    if (options.solver == PoseGraphSolver::kCeres && method == PoseGraphMethod::kGaussNewton) continue;
    options.method = method;
    EXPECT_NEAR(solve_pose_graph(world.graph, options).chi2_after, expected, 1e-6 * expected)
        << name_of(method);
  }
}

TEST_P(PoseGraphSolvers, AgreeWhateverTheMethod) {
  expect_same_as_ceres<SE3>(options());
  expect_same_as_ceres<SE2>(options());
}

template <class Pose>
void expect_held(const PoseGraphOptions& options) {
  auto world = make_loop_world<Pose>({}, 4);
  world.graph.fixed.assign(world.graph.T_world_vertex.size(), false);
  world.graph.fixed[7] = true;
  const auto solution = solve_pose_graph(world.graph, options);
  EXPECT_LT(edge_error(solution.T_world_vertex[7], world.graph.T_world_vertex[7], Pose{}).norm(), 1e-12);
  EXPECT_GT(edge_error(solution.T_world_vertex[0], world.graph.T_world_vertex[0], Pose{}).norm(), 1e-3);
}

TEST_P(PoseGraphSolvers, DoNotMoveFixedVertices) {
  expect_held<SE3>(options());
  expect_held<SE2>(options());
}

template <class Pose>
void expect_priors_to_anchor(const PoseGraphOptions& options) {
  auto world = make_loop_world<Pose>({.sigma = 0}, 5);
  const Pose moved = world.truth[10] * world.truth[3];
  world.graph.edges.push_back({kWorld, 3, moved, BasicPoseGraph<Pose>::Matrix::Identity(), false});
  const auto solution = solve_pose_graph(world.graph, options);
  EXPECT_LT(largest_difference(solution.T_world_vertex,
                               [&] {
                                 std::vector<Pose> expected;
                                 for (const Pose& T : world.truth)
                                   expected.push_back(moved * world.truth[3].inverse() * T);
                                 return expected;
                               }()),
            1e-4);
}

TEST_P(PoseGraphSolvers, PriorsAnchorTheGraph) {
  expect_priors_to_anchor<SE3>(options());
  expect_priors_to_anchor<SE2>(options());
}

TEST_P(PoseGraphSolvers, SolveDisconnectedComponents) {
  auto world = make_loop_world<SE3>({.rounds = 2, .sigma = 0}, 6);
  PoseGraph both = world.graph;
  const auto count = static_cast<uint32_t>(world.truth.size());
  both.T_world_vertex.insert(both.T_world_vertex.end(), world.graph.T_world_vertex.begin(),
                             world.graph.T_world_vertex.end());
  for (auto edge : world.graph.edges) {
    edge.a += count;
    edge.b += count;
    both.edges.push_back(edge);
  }
  ASSERT_EQ(count_connected_components(both), 2U);
  const auto solution = solve_pose_graph(both, options());
  const std::vector<SE3> second(solution.T_world_vertex.begin() + count, solution.T_world_vertex.end());
  EXPECT_LT(largest_difference(second, world.truth), 1e-5);
}

TEST_P(PoseGraphSolvers, HandleUnderdeterminedGraphs) {
  auto world = make_loop_world<SE3>({.sigma = 0.01}, 7);
  for (auto& edge : world.graph.edges) {
    edge.information.setZero();
    edge.information.diagonal().head<3>().setConstant(100);  // positions only
  }
  const auto solution = solve_pose_graph(world.graph, options());
  EXPECT_LT(solution.chi2_after, solution.chi2_before);
  ASSERT_EQ(solution.T_world_vertex.size(), world.graph.T_world_vertex.size());
  for (const SE3& T : solution.T_world_vertex) EXPECT_TRUE(T.is_finite());
}

TEST_P(PoseGraphSolvers, ReturnTheStartIfAllVerticesAreFixed) {
  const auto empty = solve_pose_graph(PoseGraph{}, options());
  EXPECT_TRUE(empty.T_world_vertex.empty());
  EXPECT_TRUE(empty.converged);

  auto world = make_loop_world<SE3>({}, 8);
  world.graph.fixed.assign(world.truth.size(), true);
  const auto held = solve_pose_graph(world.graph, options());
  EXPECT_EQ(held.chi2_after, held.chi2_before);
  EXPECT_EQ(held.iterations, 0);

  world.graph.fixed.clear();
  world.graph.edges.clear();
  EXPECT_EQ(solve_pose_graph(world.graph, options()).chi2_after, 0);
}

TEST_P(PoseGraphSolvers, StopAtMaxIterations) {
  const auto world = make_loop_world<SE3>({.sigma = 0.05, .start_sigma = 0.3}, 9);
  PoseGraphOptions one = options();
  one.start = PoseGraphStart::kGiven;
  one.max_iterations = 1;
  const auto solution = solve_pose_graph(world.graph, one);
  EXPECT_EQ(solution.iterations, 1);
  EXPECT_FALSE(solution.converged);
}

TEST_P(PoseGraphSolvers, AreDeterministic) {
  const auto world = make_loop_world<SE3>({.sigma = 0.05}, 10);
  const auto first = solve_pose_graph(world.graph, options());
  const auto second = solve_pose_graph(world.graph, options());
  ASSERT_EQ(first.T_world_vertex.size(), world.graph.T_world_vertex.size());
  for (size_t i = 0; i < first.T_world_vertex.size(); ++i) {
    EXPECT_EQ(first.T_world_vertex[i].translation, second.T_world_vertex[i].translation);
    EXPECT_EQ(first.T_world_vertex[i].rotation.coeffs(), second.T_world_vertex[i].rotation.coeffs());
  }
}

TEST_P(PoseGraphSolvers, MinimiseTheSameRobustCost) {
  // The Huber cost has one minimum near the start, which all solvers find.
  const auto world = make_loop_world<SE3>({.sigma = 0.01, .false_loops = 0.1, .start_sigma = 0.01}, 11);
  PoseGraphOptions robust = options();
  robust.robust_kernel = RobustKernel::kHuber;
  robust.start = PoseGraphStart::kGiven;
  const auto solution = solve_pose_graph(world.graph, robust);
  robust.solver = PoseGraphSolver::kCeres;
  EXPECT_LT(largest_difference(solution.T_world_vertex, solve_pose_graph(world.graph, robust).T_world_vertex),
            1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, PoseGraphSolvers,
                         testing::Values(PoseGraphSolver::kAuto, PoseGraphSolver::kBuiltin,
                                         PoseGraphSolver::kCeres, PoseGraphSolver::kG2o),
                         [](const auto& test) { return std::string(name_of(test.param)); });

class RobustKernels : public testing::TestWithParam<RobustKernel> {};

TEST_P(RobustKernels, RejectFalseLoopClosures) {
  const auto world =
      make_loop_world<SE3>({.rounds = 4, .sigma = 0.002, .false_loops = 0.3, .start_sigma = 0.02}, 12);
  PoseGraphOptions options;
  const double plain = largest_difference(solve_pose_graph(world.graph, options).T_world_vertex, world.truth);
  options.robust_kernel = GetParam();
  const double robust =
      largest_difference(solve_pose_graph(world.graph, options).T_world_vertex, world.truth);
  EXPECT_GT(plain, 0.3);
  EXPECT_LT(robust, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Redescending, RobustKernels,
                         testing::Values(RobustKernel::kCauchy, RobustKernel::kGemanMcClure,
                                         RobustKernel::kDcs));

TEST(RobustKernels, GraduatedNonConvexityNeedsNoGoodStart) {
  const auto world =
      make_loop_world<SE2>({.rounds = 4, .sigma = 0.002, .false_loops = 0.3, .start_sigma = 1.0}, 13);
  PoseGraphOptions options;
  options.robust_kernel = RobustKernel::kGemanMcClure;
  EXPECT_LT(largest_difference(solve_pose_graph(world.graph, options).T_world_vertex, world.truth), 0.05);
}

template <class Pose>
void expect_chordal_truth() {
  auto world = make_loop_world<Pose>({.sigma = 0, .start_sigma = 2.0}, 14);
  const auto layout = make_pose_graph_layout(world.graph, fixed_vertices(world.graph));
  const auto poses = chordal_initialization(world.graph, layout, plan_elimination(layout.pattern));
  ASSERT_TRUE(poses.has_value());
  EXPECT_LT(largest_difference(*poses, world.truth), 1e-9);
}

TEST(ChordalInitialization, IsExactWithoutNoiseWhateverTheStart) {
  expect_chordal_truth<SE3>();
  expect_chordal_truth<SE2>();
}

TEST(ChordalInitialization, FailsForUnderdeterminedPoses) {
  auto world = make_loop_world<SE3>({}, 15);
  for (auto& edge : world.graph.edges) edge.information.setZero();
  const auto layout = make_pose_graph_layout(world.graph, fixed_vertices(world.graph));
  EXPECT_FALSE(chordal_initialization(world.graph, layout, plan_elimination(layout.pattern)).has_value());
}

TEST(PoseGraphInitialization, AutoIsNeverWorseThanTheGivenPoses) {
  const auto world = make_loop_world<SE3>({.sigma = 0.1, .start_sigma = 0.5}, 16);
  PoseGraphOptions options;
  options.max_iterations = 0;
  EXPECT_LE(solve_pose_graph(world.graph, options).chi2_after, chi2(world.graph));
  options.start = PoseGraphStart::kGiven;
  EXPECT_DOUBLE_EQ(solve_pose_graph(world.graph, options).chi2_after, chi2(world.graph));
}

TEST(PoseGraphInitialization, AllSolversCanStartFromTheTreeAndFromChordalPoses) {
  const auto world = make_loop_world<SE3>({.sigma = 0.001, .start_sigma = 3.0}, 17);
  for (const auto solver : {PoseGraphSolver::kBuiltin, PoseGraphSolver::kCeres, PoseGraphSolver::kG2o}) {
    if (!pose_graph_solver_available(solver)) continue;
    for (const auto start : {PoseGraphStart::kTree, PoseGraphStart::kChordal}) {
      PoseGraphOptions options = with_solver(solver);
      options.start = start;
      EXPECT_LT(largest_difference(solve_pose_graph(world.graph, options).T_world_vertex, world.truth), 0.02)
          << name_of(solver) << " from " << name_of(start);
    }
  }
}

TEST(PoseGraphChecks, ViolatedPreconditionsThrowLogicError) {
  const PoseGraph good = make_loop_world<SE3>({}, 18).graph;
  const auto expect_refused = [](const PoseGraph& graph) {
    EXPECT_THROW(solve_pose_graph(graph), std::logic_error);
  };
  PoseGraph graph = good;
  graph.edges[0].b = 1000;
  expect_refused(graph);
  graph = good;
  graph.edges[0].b = graph.edges[0].a;
  expect_refused(graph);
  graph = good;
  graph.T_world_vertex[3].translation.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(graph);
  graph = good;
  graph.edges[5].information(2, 2) = std::numeric_limits<double>::infinity();
  expect_refused(graph);
  graph = good;
  graph.fixed.resize(3);
  expect_refused(graph);
}

TEST(PoseGraphChecks, UnavailableSolversAreNamed) {
  EXPECT_THAT(
      test::usage_error([] { solve_pose_graph(PoseGraph{}, with_solver(static_cast<PoseGraphSolver>(17))); }),
      HasSubstr("one of auto, builtin, ceres, g2o"));
  if (!pose_graph_solver_available(PoseGraphSolver::kG2o)) {
    EXPECT_THAT(test::usage_error([] { solve_pose_graph(PoseGraph{}, with_solver(PoseGraphSolver::kG2o)); }),
                HasSubstr("g2o"));
  }
  PoseGraphOptions options = with_solver(PoseGraphSolver::kCeres);
  options.method = PoseGraphMethod::kGaussNewton;
  const auto world = make_loop_world<SE3>({}, 19);
  EXPECT_THAT(test::usage_error([&] { solve_pose_graph(world.graph, options); }), HasSubstr("gauss-newton"));
}

}  // namespace
}  // namespace kinloop
