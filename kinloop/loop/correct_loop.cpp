#include "kinloop/loop/correct_loop.hpp"

#include <set>

namespace kinloop {
namespace {

PoseGraphEdge edge_between(const Map& map, KeyframeId a, KeyframeId b, int shared,
                           const LoopOptions& options) {
  PoseGraphEdge edge;
  edge.a = a.value;
  edge.b = b.value;
  edge.T_a_b = map.keyframe(a).T_world_camera.inverse() * map.keyframe(b).T_world_camera;
  edge.information = edge_information(shared, options);
  edge.is_odometry = true;
  return edge;
}

}  // namespace

std::optional<KeyframeId> predecessor(const Map& map, const Keyframe& keyframe) {
  if (keyframe.begins_component) return std::nullopt;
  uint32_t id = keyframe.id.value - 1;  // the first keyframe of a component has no predecessor
  while (map.keyframe(KeyframeId{id}).component != keyframe.component) --id;
  return KeyframeId{id};
}

Matrix6d edge_information(int shared, const LoopOptions& options) {
  const double metres = options.landmark_sigma_m;
  const double half_radians =
      0.5 * options.landmark_sigma_rad;  // the vector part of a quaternion is half the angle
  Vector6d diagonal;
  diagonal.head<3>().setConstant(shared / (metres * metres));
  diagonal.tail<3>().setConstant(shared / (half_radians * half_radians));
  return diagonal.asDiagonal();
}

PoseGraph make_pose_graph(const Map& map, const LoopOptions& options) {
  PoseGraph graph;
  std::set<uint32_t> held;
  for (const Keyframe& keyframe : map.keyframes()) {
    graph.T_world_vertex.push_back(keyframe.T_world_camera);
    graph.fixed.push_back(held.insert(keyframe.component).second);
  }
  for (const Keyframe& keyframe : map.keyframes()) {
    const auto previous = predecessor(map, keyframe);
    bool connected_to_previous = !previous;
    for (const auto& [older, shared] : map.covisible_keyframes(keyframe.id, 1)) {
      if (older > keyframe.id) continue;
      if (shared < options.covisibility_edge_min_landmarks && older != previous) continue;
      graph.edges.push_back(edge_between(map, older, keyframe.id, shared, options));
      connected_to_previous = connected_to_previous || older == previous;
    }
    if (!connected_to_previous) graph.edges.push_back(edge_between(map, *previous, keyframe.id, 1, options));
  }
  for (const LoopClosure& loop : map.loop_closures()) {
    PoseGraphEdge edge;
    edge.a = loop.a.value;
    edge.b = loop.b.value;
    edge.T_a_b = loop.T_a_b;
    edge.information = loop.information;
    graph.edges.push_back(edge);
  }
  return graph;
}

LoopCorrectionProblem make_loop_correction_problem(const Map& map, LandmarkMerges merges,
                                                   const LoopOptions& options) {
  return {make_pose_graph(map, options), std::move(merges), map.keyframes().back().id, map.epoch()};
}

MapUpdate correct_loop(const LoopCorrectionProblem& problem, const LoopOptions& options) {
  const PoseGraphSolution solution = solve_pose_graph(problem.graph, options.pose_graph);
  MapUpdate update;
  update.newest_keyframe = problem.newest_keyframe;
  update.epoch = problem.epoch;
  update.merges = problem.merges;
  for (uint32_t i = 0; i < solution.T_world_vertex.size(); ++i) {
    update.T_world_camera.emplace_back(KeyframeId{i}, solution.T_world_vertex[i]);
  }
  return update;
}

}  // namespace kinloop
