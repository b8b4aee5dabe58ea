#include "kinloop/optimize/pose_graph/solvers/pose_graph_structure.hpp"

#include <algorithm>
#include <numeric>

namespace kinloop {
namespace {

/// Returns the edges at each vertex in order, without priors.
template <class Pose>
std::vector<std::vector<size_t>> edges_at_vertices(const BasicPoseGraph<Pose>& graph) {
  std::vector<std::vector<size_t>> edges_at(graph.T_world_vertex.size());
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (graph.edges[i].a == kWorld) continue;
    edges_at[graph.edges[i].a].push_back(i);
    edges_at[graph.edges[i].b].push_back(i);
  }
  return edges_at;
}

size_t find_root(std::vector<size_t>& parents, size_t vertex) {
  while (parents[vertex] != vertex) vertex = parents[vertex] = parents[parents[vertex]];
  return vertex;
}

}  // namespace

template <class Pose>
std::vector<size_t> connected_components(const BasicPoseGraph<Pose>& graph) {
  std::vector<size_t> parents(graph.T_world_vertex.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (const auto& edge : graph.edges) {
    if (edge.a == kWorld) continue;
    const size_t root_a = find_root(parents, edge.a), root_b = find_root(parents, edge.b);
    // Makes the root the first vertex of its component.
    parents[std::max(root_a, root_b)] = std::min(root_a, root_b);
  }
  std::vector<size_t> parts(parents.size());
  size_t count = 0;
  for (size_t vertex = 0; vertex < parents.size(); ++vertex) {
    const size_t root = find_root(parents, vertex);
    parts[vertex] = root == vertex ? count++ : parts[root];
  }
  return parts;
}

template <class Pose>
std::vector<bool> fixed_vertices(const BasicPoseGraph<Pose>& graph) {
  const std::vector<size_t> parts = connected_components(graph);
  std::vector<bool> held(parts.size(), false);
  std::vector<bool> anchored(parts.size(), false);
  for (size_t vertex = 0; vertex < graph.fixed.size(); ++vertex) {
    if (!graph.fixed[vertex]) continue;
    held[vertex] = true;
    anchored[parts[vertex]] = true;
  }
  for (const auto& edge : graph.edges) {
    if (edge.a == kWorld) anchored[parts[edge.b]] = true;
  }
  for (size_t vertex = 0; vertex < parts.size(); ++vertex) {
    if (anchored[parts[vertex]]) continue;
    held[vertex] = true;
    anchored[parts[vertex]] = true;
  }
  return held;
}

template <class Pose>
std::vector<Pose> propagate_poses(const BasicPoseGraph<Pose>& graph, std::vector<Pose> T_world_vertex,
                                  const std::vector<uint32_t>& known) {
  std::vector<uint32_t> queue(known.rbegin(), known.rend());
  std::vector<bool> is_known(T_world_vertex.size(), false);
  for (const uint32_t vertex : known) is_known[vertex] = true;
  const auto edges_at = edges_at_vertices(graph);
  for (size_t next = 0; next < queue.size(); ++next) {
    const uint32_t from = queue[next];
    for (const size_t index : edges_at[from]) {
      const auto& edge = graph.edges[index];
      const uint32_t to = edge.a == from ? edge.b : edge.a;
      if (is_known[to]) continue;
      T_world_vertex[to] = T_world_vertex[from] * (edge.a == from ? edge.T_a_b : edge.T_a_b.inverse());
      is_known[to] = true;
      queue.push_back(to);
    }
  }
  return T_world_vertex;
}

template <class Pose>
std::vector<Pose> spanning_tree_poses(const BasicPoseGraph<Pose>& graph) {
  std::vector<Pose> T_world_vertex = graph.T_world_vertex;
  std::vector<bool> is_known = fixed_vertices(graph);
  for (const auto& edge : graph.edges) {
    if (edge.a != kWorld || is_known[edge.b]) continue;
    T_world_vertex[edge.b] = edge.T_a_b;
    is_known[edge.b] = true;
  }
  std::vector<uint32_t> known;
  for (uint32_t vertex = 0; vertex < is_known.size(); ++vertex) {
    if (is_known[vertex]) known.push_back(vertex);
  }
  return propagate_poses(graph, std::move(T_world_vertex), known);
}

template <class Pose>
size_t count_connected_components(const BasicPoseGraph<Pose>& graph) {
  const std::vector<size_t> parts = connected_components(graph);
  return parts.empty() ? 0 : *std::max_element(parts.begin(), parts.end()) + 1;
}

template std::vector<size_t> connected_components(const PoseGraph&);
template std::vector<size_t> connected_components(const PoseGraph2d&);
template std::vector<bool> fixed_vertices(const PoseGraph&);
template std::vector<bool> fixed_vertices(const PoseGraph2d&);
template size_t count_connected_components(const PoseGraph&);
template size_t count_connected_components(const PoseGraph2d&);
template std::vector<SE3> propagate_poses(const PoseGraph&, std::vector<SE3>, const std::vector<uint32_t>&);
template std::vector<SE2> propagate_poses(const PoseGraph2d&, std::vector<SE2>, const std::vector<uint32_t>&);
template std::vector<SE3> spanning_tree_poses(const PoseGraph&);
template std::vector<SE2> spanning_tree_poses(const PoseGraph2d&);

}  // namespace kinloop
