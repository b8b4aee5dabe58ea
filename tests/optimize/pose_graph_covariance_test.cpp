#include <array>

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "tests/optimize/pose_graph_world.hpp"

namespace kinloop {
namespace {

TEST(MarginalCovariances, AddUpAlongAPlanarChain) {
  PoseGraph2d graph;
  graph.T_world_vertex = {SE2{}, SE2{{1, 0}, 0}, SE2{{3, 0}, 0}};
  const Eigen::Matrix3d information = Eigen::Vector3d(100, 100, 400).asDiagonal();
  graph.edges = {{0, 1, SE2{{1, 0}, 0}, information}, {1, 2, SE2{{2, 0}, 0}, information}};
  const std::array<uint32_t, 3> vertices = {0, 1, 2};
  const auto covariances = marginal_covariances(graph, vertices);
  ASSERT_TRUE(covariances.has_value());
  EXPECT_EQ(covariances->at(0), Eigen::Matrix3d::Zero()) << "constant";
  EXPECT_LT((covariances->at(1) - information.inverse()).norm(), 1e-12);
  EXPECT_NEAR(covariances->at(2)(0, 0), 2 * 0.01, 1e-12);  // along the chain
  EXPECT_NEAR(covariances->at(2)(1, 1), 2 * 0.01 + 4 * 0.0025,
              1e-12);  // the angle at 1 moves the end of a 2 m lever
  EXPECT_NEAR(covariances->at(2)(2, 2), 2 * 0.0025, 1e-12);
}

TEST(MarginalCovariances, MatchTheScatterOfTheSolutions) {
  // Solutions with new noise scatter according to the covariance; 3 degrees of freedom, 300 trials.
  const auto truth = test::make_loop_world<SE2>({.sigma = 0}, 1);
  PoseGraph2d exact = truth.graph;
  exact.T_world_vertex = truth.truth;
  constexpr double kSigma = 0.01;
  for (auto& edge : exact.edges) edge.information = Eigen::Matrix3d::Identity() / (kSigma * kSigma);
  const std::array<uint32_t, 1> vertices = {30};
  const auto covariance = marginal_covariances(exact, vertices).value().at(0);
  Random random(2);
  double sum = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    PoseGraph2d noisy = exact;
    for (auto& edge : noisy.edges)
      edge.T_a_b = retract(edge.T_a_b, test::random_tangent<SE2>(random, kSigma));
    const SE2 solved = solve_pose_graph(noisy).T_world_vertex[30];
    const Eigen::Vector3d d = edge_error(truth.truth[30], solved, SE2{});
    sum += d.dot(covariance.inverse() * d);
  }
  EXPECT_NEAR(sum / kTrials, 3, 0.5);
}

TEST(MarginalCovariances, FailForUnderdeterminedPoses) {
  auto world = test::make_loop_world<SE3>({}, 3);
  for (auto& edge : world.graph.edges) edge.information.setZero();
  const std::array<uint32_t, 1> vertices = {5};
  EXPECT_FALSE(marginal_covariances(world.graph, vertices).has_value());
}

}  // namespace
}  // namespace kinloop
