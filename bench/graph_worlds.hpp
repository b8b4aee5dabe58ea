#pragma once
// Synthetic and degraded pose graphs for bench_graphs.

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinloop/core/random.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"

namespace kinloop {

/// Perturbs every pose but the first by noise of that size.
template <class Pose>
BasicPoseGraph<Pose> with_noise(BasicPoseGraph<Pose> graph, double sigma) {
  Random random(1);
  for (size_t i = 1; i < graph.T_world_vertex.size(); ++i) {
    typename BasicPoseGraph<Pose>::Vector d;
    for (int k = 0; k < d.size(); ++k) d[k] = sigma * random.gaussian();
    graph.T_world_vertex[i] = retract(graph.T_world_vertex[i], d);
  }
  return graph;
}

template <class Pose>
BasicPoseGraph<Pose> without_start(BasicPoseGraph<Pose> graph) {
  std::fill(graph.T_world_vertex.begin(), graph.T_world_vertex.end(), Pose{});
  return graph;
}

/// A random walk on the unit grid in space, with an edge to an earlier pose wherever it revisits a cell.
inline PoseGraph grid_walk(uint32_t count) {
  constexpr double kSigma = 0.02;  // metres, radians
  Random random(count);
  const auto side = static_cast<int64_t>(std::cbrt(count)) + 2;
  const Matrix6d information = Matrix6d::Identity() / (kSigma * kSigma);
  std::vector<SE3> truth = {SE3{}};
  std::vector<uint32_t> last_at(static_cast<size_t>(side * side * side), kWorld);
  PoseGraph graph;
  const auto measure = [&](uint32_t a, uint32_t b) {
    Vector6d noise;
    for (double& value : noise) value = kSigma * random.gaussian();
    graph.edges.push_back({a, b, retract(truth[a].inverse() * truth[b], noise), information, b == a + 1});
  };
  Eigen::Vector3i cell = Eigen::Vector3i::Zero();
  while (truth.size() < count) {
    const int axis = static_cast<int>(random.index(3));
    const int step = random.index(2) == 0 ? 1 : -1;
    if (cell[axis] + step < 0 || cell[axis] + step >= side) continue;
    cell[axis] += step;
    Vector6d turn = Vector6d::Zero();
    for (int i = 3; i < 6; ++i) turn[i] = random.uniform(-0.5, 0.5);
    SE3 T = retract(truth.back(), turn);
    T.translation = cell.cast<double>();
    truth.push_back(T);
    const auto index = static_cast<uint32_t>(truth.size() - 1);
    measure(index - 1, index);
    uint32_t& last = last_at[static_cast<size_t>((cell.x() * side + cell.y()) * side + cell.z())];
    if (last != kWorld && last + 1 < index) measure(last, index);
    last = index;
  }
  graph.T_world_vertex.resize(count);
  graph.T_world_vertex = spanning_tree_poses(graph);
  return graph;
}

/// Adds `share` times the number of loop edges as false loop edges.
template <class Pose>
BasicPoseGraph<Pose> with_false_loops(BasicPoseGraph<Pose> graph, double share) {
  Random random(7);
  const auto count = static_cast<uint32_t>(graph.T_world_vertex.size());
  std::vector<size_t> loops;
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (!graph.edges[i].is_odometry) loops.push_back(i);
  }
  const auto wanted = static_cast<size_t>(share * static_cast<double>(loops.size()));
  for (size_t i = 0; i < wanted; ++i) {
    auto edge =
        graph.edges[loops[random.index(static_cast<uint32_t>(loops.size()))]];  // a correct measurement ...
    do {
      edge.a = random.index(count);  // ... between the wrong poses
      edge.b = random.index(count);
    } while (edge.a == edge.b);
    graph.edges.push_back(edge);
  }
  return graph;
}

}  // namespace kinloop
