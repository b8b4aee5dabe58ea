#include "apps/map/withdraw_loops.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"

namespace kinloop {
namespace {

/// The landmarks that both keyframes observe: the points by the depth of `a`, the measurements of `b`.
std::vector<PoseObservation> shared_observations(const Keyframe& a, const Keyframe& b, const Map& map,
                                                 const PinholeCamera& camera) {
  std::vector<PoseObservation> observations;
  for (uint32_t in_a = 0; in_a < a.landmark_of.size(); ++in_a) {
    const auto depth_m = static_cast<double>(a.features->depths_m[in_a]);
    if (!a.landmark_of[in_a].valid() || !(depth_m > 0)) continue;
    for (const Observation& seen : map.landmark(a.landmark_of[in_a]).observations) {
      if (seen.keyframe != b.id) continue;
      observations.push_back({compensated_measurement(*b.features, seen.feature),
                              camera.unproject(a.features->pixels[in_a].cast<double>(), depth_m)});
    }
  }
  return observations;
}

/// The relative pose as two keyframes alone measure it; nullopt if they share too little.
std::optional<SE3> measured_pose(const PoseGraphEdge& edge, const Map& map, const Sensor& sensor,
                                 const AbsolutePoseOptions& options) {
  const Keyframe &a = map.keyframe(KeyframeId{edge.a}), &b = map.keyframe(KeyframeId{edge.b});
  const auto observations = shared_observations(a, b, map, sensor.camera);
  const auto solution = solve_absolute_pose(sensor, observations, edge.T_a_b, options);
  return solution ? std::optional(solution->T_reference_camera) : std::nullopt;
}

/// Solves the pose graph of all loops and of odometry that no loop has bent.
void solve_again(Map& map, const Sensor& sensor, const PlaceOptions& options) {
  PoseGraph graph = make_pose_graph(map, options.loop);
  for (PoseGraphEdge& edge : graph.edges)
    edge.T_a_b = measured_pose(edge, map, sensor, options.tracking.pose).value_or(edge.T_a_b);
  const std::vector<SE3> T_world_vertex = solve_pose_graph(graph, options.loop.pose_graph).T_world_vertex;
  MapUpdate update;
  update.newest_keyframe = map.keyframes().back().id;
  update.epoch = map.epoch();
  for (uint32_t i = 0; i < T_world_vertex.size(); ++i)
    update.T_world_camera.emplace_back(KeyframeId{i}, T_world_vertex[i]);
  map.apply(update);
}

}  // namespace

void withdraw_loops(SavedMap& saved, std::span<const LoopEnds> loops, const Sensor& sensor,
                    const PlaceOptions& options) {
  Map map;
  map.append(std::move(saved.map));
  const std::vector<SE3> before = map.withdraw_loops(loops, LoopReason::kByUser);
  if (!before.empty()) saved.frames = rebased_after_split(std::move(saved.frames), map, before);
  solve_again(map, sensor, options);
  saved.map = map.data();
}

}  // namespace kinloop
