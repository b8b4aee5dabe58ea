#include "kinloop/loop/correction/drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinloop {
namespace {

// Feature-based RGB-D odometry drifts by 1 to 2 % of the path (Sturm et al. 2012; Mur-Artal and Tardos 2017).
constexpr double kDriftPerMetre_m = 0.05;
constexpr double kDriftPerMetre_rad = 0.03;
// Error of the landmarks that tie the ends of the path, and of the time stamps under fast motion.
constexpr double kBaseDrift_m = 0.1;
constexpr double kBaseDrift_rad = 0.1;

/// Part of a path between two keyframes.
struct PathStep {
  uint32_t a, b;
  double length_m;
};

double path_length_m(const SE3& T_a_b) {
  return T_a_b.translation.norm() + T_a_b.angle_rad();
}

/// Steps between successive keyframes in ascending order, then loop closures.
std::vector<PathStep> path_steps(const Map& map) {
  std::vector<PathStep> steps;
  for (const Keyframe& keyframe : map.keyframes()) {
    const auto previous = map.predecessor(keyframe.id);
    if (!previous) continue;
    const SE3 T_a_b = map.relative_pose(*previous, keyframe.id);
    steps.push_back({previous->value, keyframe.id.value, path_length_m(T_a_b)});
  }
  for (const LoopClosure& loop : map.loop_closures())
    steps.push_back({loop.a.value, loop.b.value, path_length_m(loop.T_a_b)});
  return steps;
}

/// Shortens the distance to either end of a step by way of the other; true if one became shorter.
bool relax(const PathStep& step, std::vector<double>& distances) {
  double &a = distances[step.a], &b = distances[step.b];
  if (b > a + step.length_m) {
    b = a + step.length_m;
    return true;
  }
  if (a > b + step.length_m) {
    a = b + step.length_m;
    return true;
  }
  return false;
}

}  // namespace

std::vector<double> travelled_distances(const Map& map, KeyframeId keyframe) {
  std::vector<double> distances(map.keyframes().size(), std::numeric_limits<double>::infinity());
  distances[keyframe.value] = 0;
  const auto steps = path_steps(map);
  // Bellman-Ford. A sweep in each direction crosses all successive keyframes, so few sweeps are needed.
  for (bool changed = true; changed;) {
    changed = false;
    for (const PathStep& step : steps) changed = relax(step, distances) || changed;
    for (auto step = steps.rbegin(); step != steps.rend(); ++step)
      changed = relax(*step, distances) || changed;
  }
  return distances;
}

DriftBound drift_bound(double distance_m) {
  return {kBaseDrift_m + kDriftPerMetre_m * distance_m, kBaseDrift_rad + kDriftPerMetre_rad * distance_m};
}

double direction_bound_rad(const DriftBound& bound, const Eigen::Vector3d& p_camera) {
  return bound.rotation_rad + std::asin(std::min(1.0, bound.translation_m / p_camera.norm()));
}

std::optional<PredictedView> predict_view(const Map& map, KeyframeId reference, KeyframeId camera,
                                          double travelled_m) {
  if (!std::isfinite(travelled_m)) return std::nullopt;
  const SE3 T_reference_camera = map.relative_pose(reference, camera);
  return PredictedView{T_reference_camera, drift_bound(travelled_m)};
}

bool is_explained_by_drift(const PredictedView& predicted, const SE3& T_reference_camera) {
  const SE3 error = predicted.T_reference_camera.inverse() * T_reference_camera;
  // The position is that of the camera in the reference, which turns with the rotation error of the path.
  const double lever_m = predicted.T_reference_camera.translation.norm();
  return error.angle_rad() <= predicted.bound.rotation_rad &&
         error.translation.norm() <= predicted.bound.translation_m + predicted.bound.rotation_rad * lever_m;
}

bool may_overlap(const Features& reference, const PredictedView& predicted, const PinholeCamera& camera,
                 int min_keypoints) {
  const SE3 T_camera_reference = predicted.T_reference_camera.inverse();
  const double half_view_rad =
      std::atan(0.5 * std::hypot(camera.width / camera.fx, camera.height / camera.fy));
  int visible = 0;
  for (size_t i = 0; i < reference.size() && visible < min_keypoints; ++i) {
    const auto depth_m = static_cast<double>(reference.depths_m[i]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d p_camera =
        T_camera_reference * camera.unproject(reference.pixels[i].cast<double>(), depth_m);
    const double off_axis_rad = std::atan2(p_camera.head<2>().norm(), p_camera.z());
    if (off_axis_rad <= half_view_rad + direction_bound_rad(predicted.bound, p_camera)) ++visible;
  }
  return visible >= min_keypoints;
}

}  // namespace kinloop
