#include <algorithm>
#include <limits>
#include <numbers>

#include "tools/evaluation/recognition.hpp"

namespace kinloop {
namespace {

double median(std::vector<double> values) {
  return compute_statistics(values).median;
}

/// Median difference of the motions over some fiftieths of the path, relative to the motions.
double disagreement(const Trajectory& estimate, const Trajectory& truth,
                    const std::vector<StampPair>& pairs) {
  constexpr size_t kMotions = 50;
  constexpr double kSmallRad = std::numbers::pi / 180, kSmallM = 0.01;
  std::vector<double> turns, moves;
  const size_t step = std::max<size_t>(1, pairs.size() / kMotions);
  for (size_t i = 0; i + step < pairs.size(); i += step) {
    const StampPair &from = pairs[i], &to = pairs[i + step];
    const SE3 true_motion = truth[from.a].T_world_camera.inverse() * truth[to.a].T_world_camera;
    const SE3 motion = estimate[from.b].T_world_camera.inverse() * estimate[to.b].T_world_camera;
    turns.push_back((true_motion.inverse() * motion).angle_rad() / (true_motion.angle_rad() + kSmallRad));
    moves.push_back((motion.translation - true_motion.translation).norm() /
                    (true_motion.translation.norm() + kSmallM));
  }
  return turns.empty() ? std::numeric_limits<double>::infinity() : median(turns) + median(moves);
}

}  // namespace

Trajectory with_w_first(Trajectory trajectory) {
  for (StampedPose& pose : trajectory) {
    const Eigen::Quaterniond& q = pose.T_world_camera.rotation;
    pose.T_world_camera.rotation = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w());
  }
  return trajectory;
}

WhichTrajectory find_w_first(const Trajectory& estimate, const Trajectory& truth,
                             const WhichTrajectory& may_be, const EvaluationOptions& options) {
  constexpr double kFarBetter = 0.5;
  const auto pairs =
      pair_poses(shifted(estimate, options.offset_ns), truth, options.max_difference_ns, options.convention);
  WhichTrajectory found;
  double least = kFarBetter * disagreement(estimate, truth, pairs);
  for (const WhichTrajectory& candidate : {WhichTrajectory{true, false}, {false, true}, {true, true}}) {
    if ((candidate.estimate && !may_be.estimate) || (candidate.truth && !may_be.truth)) continue;
    const double left = disagreement(candidate.estimate ? with_w_first(estimate) : estimate,
                                     candidate.truth ? with_w_first(truth) : truth, pairs);
    if (left < least) {
      found = candidate;
      least = left;
    }
  }
  return found;
}

}  // namespace kinloop
