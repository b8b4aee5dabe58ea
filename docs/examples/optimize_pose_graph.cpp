// Optimizes a pose graph, either a built-in one or a .g2o file.
//
//   example_optimize_pose_graph [IN.g2o OUT.g2o]

#include <cstdio>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "tools/export/g2o/g2o_file.hpp"

namespace {

/// Four poses on a square of 1 m, connected by drifting odometry and a loop closure to the first pose.
kinloop::PoseGraph square_with_drift() {
  const kinloop::SE3 side{Eigen::Quaterniond(Eigen::AngleAxisd(1.60, Eigen::Vector3d::UnitZ())),
                          {1.02, 0, 0}};
  kinloop::PoseGraph graph;
  graph.T_world_vertex.resize(4);
  for (uint32_t i = 0; i < 3; ++i) {
    graph.T_world_vertex[i + 1] = graph.T_world_vertex[i] * side;
    graph.edges.push_back({i, i + 1, side});
  }
  graph.edges.push_back({3, 0, side});
  return graph;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 3) {
    auto file = kinloop::read_g2o(argv[1]);
    std::visit(
        [](auto& graph) {
          const auto solution = kinloop::solve_pose_graph(graph);
          graph.T_world_vertex = solution.T_world_vertex;
          std::printf("chi2 %g -> %g\n", solution.chi2_before, solution.chi2_after);
        },
        file.graph);
    kinloop::write_g2o(argv[2], file);
    return 0;
  }
  const auto solution = kinloop::solve_pose_graph(square_with_drift());
  std::printf("chi2 %g -> %g\n", solution.chi2_before, solution.chi2_after);
  for (const kinloop::SE3& T : solution.T_world_vertex) {
    std::printf("%.3f %.3f %.3f\n", T.translation.x(), T.translation.y(), T.translation.z());
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
