// Error of an edge and its derivatives, robust kernels, and graph structure.

#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/optimize/pose_graph/solvers/pose_graph_kernel.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_structure.hpp"
#include "tests/optimize/pose_graph_world.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;

template <class Pose>
class PoseGraphError : public testing::Test {};
using Poses = testing::Types<SE3, SE2>;
TYPED_TEST_SUITE(PoseGraphError, Poses);

template <class Pose>
Pose random_pose(Random& random) {
  return retract(Pose{}, test::random_tangent<Pose>(random, 1.0));
}

TYPED_TEST(PoseGraphError, IsZeroWhereThePosesAgreeWithTheMeasurement) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const auto T_world_a = random_pose<TypeParam>(random), T_a_b = random_pose<TypeParam>(random);
    EXPECT_LT(edge_error(T_world_a, T_world_a * T_a_b, T_a_b).norm(), 1e-14);
  }
}

TYPED_TEST(PoseGraphError, DoesNotDependOnTheWorldFrame) {
  Random random(2);
  const auto a = random_pose<TypeParam>(random), b = random_pose<TypeParam>(random);
  const auto measured = random_pose<TypeParam>(random), world = random_pose<TypeParam>(random);
  EXPECT_LT((edge_error(a, b, measured) - edge_error(world * a, world * b, measured)).norm(), 1e-13);
}

TYPED_TEST(PoseGraphError, DerivativesAgreeWithDifferences) {
  using Vector = typename BasicPoseGraph<TypeParam>::Vector;
  constexpr double kStep = 1e-6;
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const auto a = random_pose<TypeParam>(random), b = random_pose<TypeParam>(random);
    const auto measured = random_pose<TypeParam>(random);
    const auto linear = linearize_edge(a, b, measured);
    EXPECT_LT((linear.e - edge_error(a, b, measured)).norm(), 1e-14);
    for (int k = 0; k < TypeParam::kDof; ++k) {
      const Vector d = kStep * Vector::Unit(k);
      const Vector minus_d = -d;
      const Vector J_a =
          (edge_error(retract(a, d), b, measured) - edge_error(retract(a, minus_d), b, measured)) /
          (2 * kStep);
      const Vector J_b =
          (edge_error(a, retract(b, d), measured) - edge_error(a, retract(b, minus_d), measured)) /
          (2 * kStep);
      EXPECT_LT((linear.de_da.col(k) - J_a).norm(), 1e-7) << "derivative by component " << k << " of a";
      EXPECT_LT((linear.de_db.col(k) - J_b).norm(), 1e-7) << "derivative by component " << k << " of b";
    }
  }
}

TEST(PoseGraphErrorInSpace, IsTheTranslationAndTheVectorPartOfTheQuaternion) {
  const SE3 T_world_b{exp_so3({0, 0, 0.4}), {1, 2, 3}};
  const Vector6d e = edge_error(SE3{}, T_world_b, SE3{});
  Vector6d expected;
  expected << 1, 2, 3, 0, 0, std::sin(0.2);
  EXPECT_LT((e - expected).norm(), 1e-15);
}

TEST(PoseGraphErrorInSpace, UsesTheQuaternionWithPositiveRealPart) {
  SE3 T_world_b{exp_so3({0, 0.3, 0}), {0, 0, 0}};
  const Vector6d e = edge_error(SE3{}, T_world_b, SE3{});
  T_world_b.rotation.coeffs() *= -1;  // the same rotation
  EXPECT_EQ(e, edge_error(SE3{}, T_world_b, SE3{}));
  EXPECT_LT((linearize_edge(SE3{}, T_world_b, SE3{}).de_db -
             linearize_edge(SE3{}, SE3{exp_so3({0, 0.3, 0}), {}}, SE3{}).de_db)
                .norm(),
            1e-15);
}

TEST(PoseGraphErrorInThePlane, WrapsTheAngle) {
  const Eigen::Vector3d e = edge_error(SE2{{0, 0}, 3.0}, SE2{{0, 0}, -3.0}, SE2{});
  EXPECT_NEAR(e.z(), 2 * M_PI - 6.0, 1e-14);
}

TEST(PoseGraphChi2, IsTheSumOfWeightedSquares) {
  PoseGraph2d graph;
  graph.T_world_vertex = {SE2{}, SE2{{1, 0}, 0}, SE2{{1, 2}, 0}};
  const Eigen::Matrix3d information = Eigen::Vector3d(2, 3, 5).asDiagonal();
  graph.edges = {
      {0, 1, SE2{}, information}, {1, 2, SE2{}, information}, {kWorld, 1, SE2{{1, 0}, -0.5}, information}};
  EXPECT_NEAR(chi2(graph), 2 * 1 + 3 * 4 + 5 * 0.25, 1e-14);
}

class PoseGraphKernels : public testing::TestWithParam<RobustKernel> {};

TEST_P(PoseGraphKernels, WeightIsTheDerivativeOfRho) {
  const PoseGraphKernel kernel{GetParam(), 1.7};
  EXPECT_EQ(kernel.rho(0), 0);
  EXPECT_NEAR(kernel.weight(0), 1, 1e-15);
  for (const double s : {0.1, 1.0, 2.5, 3.3, 10.0, 1000.0}) {
    const double step = 1e-6 * s;
    EXPECT_NEAR((kernel.rho(s + step) - kernel.rho(s - step)) / (2 * step), kernel.weight(s), 1e-6)
        << "at " << s;
    EXPECT_LE(kernel.rho(s), s * (1 + 1e-15));
  }
}

INSTANTIATE_TEST_SUITE_P(All, PoseGraphKernels,
                         testing::Values(RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy,
                                         RobustKernel::kGemanMcClure, RobustKernel::kDcs));

PoseGraph2d two_parts() {
  PoseGraph2d graph;
  graph.T_world_vertex.resize(5);
  const SE2 step{{1, 0}, 0.1};
  graph.edges = {{0, 2, step, Eigen::Matrix3d::Identity()}, {4, 1, step, Eigen::Matrix3d::Identity()}};
  return graph;
}

TEST(PoseGraphStructure, FindsConnectedComponents) {
  EXPECT_THAT(connected_components(two_parts()), ElementsAre(0, 1, 0, 2, 1));
  EXPECT_EQ(count_connected_components(two_parts()), 3U);
  EXPECT_EQ(count_connected_components(PoseGraph{}), 0U);
}

TEST(PoseGraphStructure, FixesTheFirstVertexOfUnanchoredComponents) {
  PoseGraph2d graph = two_parts();
  EXPECT_THAT(fixed_vertices(graph), ElementsAre(true, true, false, true, false));
  graph.fixed = {false, false, true, false, false};
  graph.edges.push_back({kWorld, 4, SE2{}, Eigen::Matrix3d::Identity()});
  EXPECT_THAT(fixed_vertices(graph), ElementsAre(false, false, true, true, false));
}

TEST(PoseGraphStructure, ChainsPosesAlongEdgesInBothDirections) {
  PoseGraph2d graph = two_parts();
  graph.T_world_vertex[1] = SE2{{5, 5}, 1};
  const auto chained = spanning_tree_poses(graph);
  EXPECT_LT(edge_error(chained[0], chained[2], graph.edges[0].T_a_b).norm(), 1e-15);
  EXPECT_LT(edge_error(chained[4], chained[1], graph.edges[1].T_a_b).norm(), 1e-15);
  EXPECT_EQ(chained[1].translation, Eigen::Vector2d(5, 5));
}

TEST(PoseGraphStructure, ComponentWithAPriorStartsThere) {
  PoseGraph2d graph = two_parts();
  const SE2 measured{{-1, 4}, 0.7};
  graph.edges.push_back({kWorld, 4, measured, Eigen::Matrix3d::Identity()});
  const auto chained = spanning_tree_poses(graph);
  EXPECT_LT(edge_error(SE2{}, chained[4], measured).norm(), 1e-15);
  EXPECT_LT(edge_error(SE2{}, chained[1], measured * graph.edges[1].T_a_b).norm(), 1e-15);
}

}  // namespace
}  // namespace kinloop
