#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {
namespace {

// Half of the variance that tracking adds: the adjustment averages over views that a single pose does not
// have. Learned on simulated sequences with seeds 101 to 105, with and without loops
// (docs/lab/measurements.md#consistency-of-the-covariances).
constexpr double kLeftByAdjustment = 0.5;
constexpr double kMinVariance = 1e-12;  // m^2 and rad^2: a step of unknown covariance counts as exact
constexpr int kMinShared = 30;          // landmarks, of a revisit

PoseGraphEdge edge_between(const Map& map, KeyframeId a, KeyframeId b, const Matrix6d& covariance) {
  const Matrix6d information =
      (covariance + kMinVariance * Matrix6d::Identity()).llt().solve(Matrix6d::Identity());
  // The error of an edge has half the angle.
  Vector6d to_error;
  to_error << 1, 1, 1, 2, 2, 2;
  return {a.value, b.value, map.relative_pose(a, b),
          to_error.asDiagonal() * information * to_error.asDiagonal()};
}

/// Returns the older keyframes that see landmarks of this one and from which the camera had looked away in
/// between.
std::vector<KeyframeId> revisited(const Map& map, KeyframeId keyframe) {
  std::vector<KeyframeId> older;
  for (const auto& [other, shared] : map.covisible_keyframes(keyframe, kMinShared)) {
    if (other < keyframe) older.push_back(other);
  }
  std::sort(older.begin(), older.end(), std::greater<>());
  KeyframeId next = keyframe;
  const auto gap = std::find_if(older.begin(), older.end(), [&](KeyframeId other) {
    return std::exchange(next, other).value != other.value + 1;
  });
  return {gap, older.end()};
}

void add_edges(const Map& map, KeyframeId keyframe, const KeyframeStep& step, PoseGraph& graph) {
  const Matrix6d covariance = kLeftByAdjustment * step.covariance;
  if (step.reference.valid()) graph.edges.push_back(edge_between(map, step.reference, keyframe, covariance));
  for (const KeyframeId other : revisited(map, keyframe))
    graph.edges.push_back(edge_between(map, other, keyframe, covariance));
}

}  // namespace

std::vector<Matrix6d> drift_covariances(const Map& map, std::span<const std::optional<KeyframeStep>> steps) {
  PoseGraph graph;
  std::vector<bool> has_first(map.component_count(), false);
  for (const Keyframe& keyframe : map.keyframes()) {
    const bool is_exact = keyframe.id.value >= steps.size() || !steps[keyframe.id.value];
    graph.T_world_vertex.push_back(keyframe.T_world_camera);
    graph.fixed.push_back(is_exact || !has_first[keyframe.component]);
    has_first[keyframe.component] = true;
    if (!is_exact) add_edges(map, keyframe.id, *steps[keyframe.id.value], graph);
  }
  for (const LoopClosure& loop : map.loop_closures())
    graph.edges.push_back({loop.a.value, loop.b.value, loop.T_a_b, loop.information});
  std::vector<uint32_t> all(map.keyframes().size());
  std::iota(all.begin(), all.end(), 0U);
  const auto found = marginal_covariances(graph, all);
  return found ? *found : std::vector<Matrix6d>(all.size(), Matrix6d::Zero());
}

}  // namespace kinloop
