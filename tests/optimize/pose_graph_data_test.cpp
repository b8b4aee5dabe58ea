// Standard pose graphs: solvers reach the best known chi2, from the file's start and without it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shared_data.hpp"
#include "tools/export/g2o/g2o_file.hpp"

namespace kinloop {
namespace {

struct Known {
  const char* file;
  double chi2;  // best value of g2o, as published with the data
};

class StandardPoseGraphs : public testing::TestWithParam<Known> {};

double solved_chi2(const G2oFile& file, const PoseGraphOptions& options) {
  return std::visit([&](const auto& graph) { return solve_pose_graph(graph, options).chi2_after; },
                    file.graph);
}

/// The same graph without its initial values.
G2oFile without_start(G2oFile file) {
  std::visit(
      [](auto& graph) {
        std::fill(graph.T_world_vertex.begin() + 1, graph.T_world_vertex.end(), graph.T_world_vertex[0]);
      },
      file.graph);
  return file;
}

TEST_P(StandardPoseGraphs, ReachTheBestKnownChi2) {
  const auto path = test::shared_data("pose_graphs") / GetParam().file;
  KINLOOP_SKIP_WITHOUT(path);
  const G2oFile file = read_g2o(path);
  EXPECT_LE(solved_chi2(file, {}), GetParam().chi2 * (1 + 1e-6));
  EXPECT_LE(solved_chi2(without_start(file), {}), GetParam().chi2 * (1 + 1e-6));
}

INSTANTIATE_TEST_SUITE_P(Of, StandardPoseGraphs,
                         testing::Values(Known{"smallGrid3D.g2o", 458.1538},
                                         Known{"parking-garage.g2o", 1.23869058},
                                         Known{"sphere2500.g2o", 727.14967},
                                         Known{"torus3D.g2o", 14574.74644},
                                         Known{"sphere_bignoise_vertex3.g2o", 785283},
                                         Known{"intel.g2o", 45.0047}, Known{"MIT.g2o", 41.1633}),
                         [](const auto& test) {
                           std::string name = test.param.file;
                           name.resize(name.find('.'));
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(StandardPoseGraph, Chi2MatchesG2o) {
  // Values from g2o's libraries for the same files. The tolerance is needed in 3D: g2o uses vertex
  // quaternions as printed with six digits, kinloop normalises them first.
  const struct {
    const char* file;
    double chi2, tolerance;
  } cases[] = {{"intel.g2o", 551.73573084974043, 1e-13},
               {"smallGrid3D.g2o", 115957.99677294544, 2e-8},
               {"parking-garage.g2o", 16720.018300996719, 2e-8},
               {"sphere2500.g2o", 2547810.8488055905, 3e-8}};
  for (const auto& known : cases) {
    const auto path = test::shared_data("pose_graphs") / known.file;
    KINLOOP_SKIP_WITHOUT(path);
    const double ours = std::visit([](const auto& graph) { return chi2(graph); }, read_g2o(path).graph);
    EXPECT_NEAR(ours / known.chi2, 1, known.tolerance) << known.file;
  }
}

TEST(StandardPoseGraph, SolversAgreeOnSmallGrid3D) {
  const auto path = test::shared_data("pose_graphs/smallGrid3D.g2o");
  KINLOOP_SKIP_WITHOUT(path);
  const G2oFile file = read_g2o(path);
  const double builtin = solved_chi2(file, {});
  for (const auto solver : {PoseGraphSolver::kCeres, PoseGraphSolver::kG2o}) {
    if (!pose_graph_solver_available(solver)) continue;
    PoseGraphOptions options;
    options.solver = solver;
    EXPECT_NEAR(solved_chi2(file, options), builtin, 1e-6 * builtin) << name_of(solver);
  }
}

TEST(StandardPoseGraph, ManhattanHasOnlyEdges) {
  const auto path = test::shared_data("pose_graphs/manhattan.g2o");
  KINLOOP_SKIP_WITHOUT(path);
  const G2oFile file = read_g2o(path);
  EXPECT_FALSE(file.had_vertices);
  const auto& graph = std::get<PoseGraph2d>(file.graph);
  EXPECT_EQ(graph.T_world_vertex.size(), 3500U);
  const auto solution = solve_pose_graph(graph);
  EXPECT_LT(solution.chi2_after, 1e-3 * solution.chi2_before);
}

TEST(StandardPoseGraph, CubicleHasIndefiniteInformation) {
  const auto path = test::shared_data("pose_graphs/cubicle.g2o");
  KINLOOP_SKIP_WITHOUT(path);
  const G2oFile file = read_g2o(path);
  EXPECT_EQ(file.repaired_lines.size(), 5021U);
}

}  // namespace
}  // namespace kinloop
