#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"
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

/// The keyframe that begins a part of a component which only a step of odometry ties to what was before.
bool begins_untied_part(const Keyframe& keyframe, KeyframeId oldest_tied_to_it) {
  return keyframe.id == oldest_tied_to_it && keyframe.odometry && keyframe.odometry->reference.valid();
}

void add_edges(const Map& map, KeyframeId keyframe, bool is_adjusted, const OdometryStep& step,
               PoseGraph& graph) {
  const Matrix6d covariance = (is_adjusted ? kLeftByAdjustment : 1) * step.covariance;
  if (step.reference.valid()) graph.edges.push_back(edge_between(map, step.reference, keyframe, covariance));
  for (const KeyframeId other : revisited(map, keyframe))
    graph.edges.push_back(edge_between(map, other, keyframe, covariance));
}

/// The covariances of the drift, as with_drift adds them.
std::vector<Matrix6d> drift_covariances(const Map& map, const std::vector<KeyframeId>& oldest_tied) {
  PoseGraph graph;
  std::vector<bool> has_first(map.component_count(), false);
  for (const Keyframe& keyframe : map.keyframes()) {
    const bool is_exact = !keyframe.odometry;
    graph.T_world_vertex.push_back(keyframe.T_world_camera);
    graph.fixed.push_back(is_exact || !has_first[keyframe.component]);
    has_first[keyframe.component] = true;
    if (is_exact) continue;
    const bool is_adjusted = !begins_untied_part(keyframe, oldest_tied[keyframe.id.value]);
    add_edges(map, keyframe.id, is_adjusted, *keyframe.odometry, graph);
  }
  for (const LoopClosure& loop : map.loop_closures())
    graph.edges.push_back({loop.a.value, loop.b.value, loop.T_a_b, loop.information});
  std::vector<uint32_t> all(map.keyframes().size());
  std::iota(all.begin(), all.end(), 0U);
  const auto found = marginal_covariances(graph, all);
  return found ? *found : std::vector<Matrix6d>(all.size(), Matrix6d::Zero());
}

/// The covariances of an adjustment are relative to the keyframe that it held constant, the oldest of a part:
/// adds that of this keyframe in the part before.
std::vector<Matrix6d> relative_to_first(std::vector<Matrix6d> covariance, const Map& map,
                                        const std::vector<KeyframeId>& oldest_tied) {
  for (const Keyframe& keyframe : map.keyframes()) {
    const KeyframeId id = keyframe.id, oldest = oldest_tied[id.value];
    if (!begins_untied_part(map.keyframe(oldest), oldest)) continue;
    const KeyframeId from = id == oldest ? keyframe.odometry->reference : oldest;
    covariance[id.value] += transported(covariance[from.value], map.relative_pose(from, id));
  }
  return covariance;
}

}  // namespace

std::vector<Matrix6d> with_drift(std::vector<Matrix6d> covariance, const Map& map) {
  if (covariance.empty()) return covariance;
  std::vector<KeyframeId> all;
  for (const Keyframe& keyframe : map.keyframes()) all.push_back(keyframe.id);
  const std::vector<KeyframeId> oldest = oldest_tied(map, all);
  covariance = relative_to_first(std::move(covariance), map, oldest);
  const std::vector<Matrix6d> drift = drift_covariances(map, oldest);
  std::transform(covariance.begin(), covariance.end(), drift.begin(), covariance.begin(), std::plus<>());
  return covariance;
}

}  // namespace kinloop
