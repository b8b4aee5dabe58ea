#include "kinloop/belief/relative_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace kinloop {
namespace {

// 1 sigma per metre of path, learned on simulated rooms with seeds 110 to 139 (docs/belief.md): 99 % of their
// motions over 4 to 16 m are no farther off than 99 % of such a normal distribution.
constexpr double kDriftPerMetre_m = 0.0085, kDriftPerMetre_rad = 0.0027;
// 1 sigma of a relative pose that matched keypoints measure: their landmarks are off, and the time stamps.
constexpr double kMeasured_m = 0.016, kMeasured_rad = 0.016;
/// Chi-square with six degrees of freedom exceeds this once in a million times: the one false-alarm rate.
constexpr double kMaxSquare = 38.26;

Matrix6d isotropic(double variance_m2, double variance_rad2) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(variance_m2), Eigen::Vector3d::Constant(variance_rad2);
  return covariance;
}

double path_length_m(const SE3& T_a_b) {
  return T_a_b.translation.norm() + T_a_b.angle_rad();
}

/// Part of a path between two keyframes: of odometry, or a loop closure.
struct PathStep {
  KeyframeId a, b;
  double length_m;
  const LoopClosure* loop;  // null for odometry
};

/// Steps between successive keyframes in ascending order, then loop closures.
std::vector<PathStep> steps_of(const Map& map) {
  std::vector<PathStep> steps;
  for (const Keyframe& keyframe : map.keyframes()) {
    const auto previous = map.predecessor(keyframe.id);
    if (!previous) continue;
    const SE3 T_a_b = map.relative_pose(*previous, keyframe.id);
    steps.push_back({*previous, keyframe.id, path_length_m(T_a_b), nullptr});
  }
  for (const LoopClosure& loop : map.loop_closures())
    steps.push_back({loop.a, loop.b, path_length_m(loop.T_a_b), &loop});
  return steps;
}

/// The pose of the camera before an inversion, seen from the camera: exp(-x) T^-1 = T^-1 exp(-Ad(T) x).
PredictedView inverse(const PredictedView& view) {
  const SE3 T_camera_reference = view.T_reference_camera.inverse();
  return {T_camera_reference, transported(view.covariance, T_camera_reference)};
}

/// The pose of one end of a step relative to the other, in the present map.
PredictedView pose_over(const PathStep& step, KeyframeId to, const Map& map) {
  PredictedView view{map.relative_pose(step.a, step.b)};
  if (step.loop != nullptr) {
    view.covariance = measured_view(*step.loop).covariance;
  } else if (const auto& odometry = map.keyframe(step.b).odometry) {
    view.covariance = odometry->covariance;
  }
  return to == step.b ? view : inverse(view);
}

/// The paths from one keyframe to all others.
struct ShortestPaths {
  std::vector<double> lengths_m;  // by keyframe; infinity without a path
  std::vector<size_t> last_step;  // of the path to each keyframe
};

/// Bellman-Ford. A sweep in each direction crosses all successive keyframes, so few sweeps are needed.
ShortestPaths shortest_paths(const std::vector<PathStep>& steps, size_t keyframes, KeyframeId from) {
  ShortestPaths paths{std::vector<double>(keyframes, std::numeric_limits<double>::infinity()),
                      std::vector<size_t>(keyframes)};
  paths.lengths_m[from.value] = 0;
  const auto shorten = [&](size_t i, KeyframeId to, KeyframeId by) {
    const double length_m = paths.lengths_m[by.value] + steps[i].length_m;
    if (!(length_m < paths.lengths_m[to.value])) return false;
    paths.lengths_m[to.value] = length_m;
    paths.last_step[to.value] = i;
    return true;
  };
  const auto relax = [&](size_t i) {
    return shorten(i, steps[i].b, steps[i].a) || shorten(i, steps[i].a, steps[i].b);
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t i = 0; i < steps.size(); ++i) changed = relax(i) || changed;
    for (size_t i = steps.size(); i-- > 0;) changed = relax(i) || changed;
  }
  return paths;
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues().z(), 0.0));
}

}  // namespace

Matrix6d transported(const Matrix6d& covariance_of_T_a_b, const SE3& T_b_c) {
  const Matrix6d adjoint = T_b_c.inverse().adjoint();
  return adjoint * covariance_of_T_a_b * adjoint.transpose();
}

Matrix6d drift_covariance(double length_m) {
  return isotropic(std::pow(kDriftPerMetre_m * length_m, 2), std::pow(kDriftPerMetre_rad * length_m, 2));
}

PredictedView measured_view(const LoopClosure& loop) {
  // The information is that of half the angles.
  Vector6d of_error;
  of_error << 1, 1, 1, 2, 2, 2;
  const Matrix6d covariance = loop.information.ldlt().solve(Matrix6d::Identity());
  return {loop.T_a_b, of_error.asDiagonal() * covariance * of_error.asDiagonal()};
}

PredictedView operator*(const PredictedView& a, const PredictedView& b) {
  return {a.T_reference_camera * b.T_reference_camera,
          transported(a.covariance, b.T_reference_camera) + b.covariance};
}

RelativePoses::RelativePoses(const Map& map, KeyframeId from) : views_(map.keyframes().size()) {
  const auto steps = steps_of(map);
  const ShortestPaths paths = shortest_paths(steps, views_.size(), from);
  lengths_m_ = paths.lengths_m;
  std::vector<bool> is_known(views_.size(), false);
  is_known[from.value] = true;
  const auto nearer_end = [&](KeyframeId to) {
    const PathStep& step = steps[paths.last_step[to.value]];
    return step.b == to ? step.a : step.b;
  };
  for (uint32_t i = 0; i < views_.size(); ++i) {
    if (!std::isfinite(lengths_m_[i])) continue;
    std::vector<KeyframeId> way;  // from here to what is known
    for (KeyframeId at{i}; !is_known[at.value]; at = nearer_end(at)) way.push_back(at);
    for (auto to = way.rbegin(); to != way.rend(); ++to) {
      const PathStep& step = steps[paths.last_step[to->value]];
      views_[to->value] = views_[nearer_end(*to).value] * pose_over(step, *to, map);
      is_known[to->value] = true;
    }
  }
}

std::optional<PredictedView> RelativePoses::pose_of(KeyframeId camera) const {
  if (!std::isfinite(path_length_m(camera))) return std::nullopt;
  PredictedView view = views_[camera.value];
  view.covariance += drift_covariance(path_length_m(camera));
  return view;
}

std::optional<PredictedView> RelativePoses::seen_from(KeyframeId reference) const {
  const auto pose = pose_of(reference);
  return pose ? std::optional(inverse(*pose)) : std::nullopt;
}

double squared_distance(const PredictedView& predicted, const SE3& T_reference_camera) {
  const Vector6d x = (predicted.T_reference_camera.inverse() * T_reference_camera).log();
  const Matrix6d measured = isotropic(kMeasured_m * kMeasured_m, kMeasured_rad * kMeasured_rad);
  return x.dot((predicted.covariance + measured).ldlt().solve(x));
}

bool is_explained(const PredictedView& predicted, const SE3& T_reference_camera) {
  return squared_distance(predicted, T_reference_camera) <= kMaxSquare;
}

ErrorMagnitude expected_error(const Matrix6d& covariance) {
  return {std::hypot(kMeasured_m, largest_sigma(covariance.topLeftCorner<3, 3>())),
          std::hypot(kMeasured_rad, largest_sigma(covariance.bottomRightCorner<3, 3>()))};
}

ErrorMagnitude largest_error(const Matrix6d& covariance) {
  const ErrorMagnitude expected = expected_error(covariance);
  const double sigmas = std::sqrt(kMaxSquare);
  return {sigmas * expected.translation_m, sigmas * expected.rotation_rad};
}

double displaced_rad(const ErrorMagnitude& error, const Eigen::Vector3d& p_camera) {
  return error.rotation_rad + std::asin(std::min(1.0, error.translation_m / p_camera.norm()));
}

bool may_overlap(const Features& reference, const PredictedView& predicted, const PinholeCamera& camera,
                 int min_keypoints) {
  const SE3 T_camera_reference = predicted.T_reference_camera.inverse();
  const ErrorMagnitude error = largest_error(predicted.covariance);
  const double half_view_rad =
      std::atan(0.5 * std::hypot(camera.width / camera.fx, camera.height / camera.fy));
  int visible = 0;
  for (size_t i = 0; i < reference.size() && visible < min_keypoints; ++i) {
    const auto depth_m = static_cast<double>(reference.depths_m[i]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d p_camera =
        T_camera_reference * camera.unproject(reference.pixels[i].cast<double>(), depth_m);
    const double off_axis_rad = std::atan2(p_camera.head<2>().norm(), p_camera.z());
    if (off_axis_rad <= half_view_rad + displaced_rad(error, p_camera)) ++visible;
  }
  return visible >= min_keypoints;
}

}  // namespace kinloop
