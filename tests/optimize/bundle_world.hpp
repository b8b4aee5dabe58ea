#pragma once
// Ground truth for the tests of bundle adjustment: a handheld Kinect-like camera with sensor errors in a room
// of points.

#include <cmath>
#include <vector>

#include "kinloop/optimize/bundle/bundle.hpp"
#include "tests/optimize/synthetic_view.hpp"

namespace kinloop::test {

struct BundleWorldSettings {
  int poses = 12;
  int points = 300;
  double spacing_s = 0.2;  // between keyframes
  double sigma_px = 0;
  double sigma_inverse_depth = 0;
  double depth_fraction = 0.7;
  double outlier_fraction = 0;
  double depth_stamp_difference_s = 0;         // largest difference of the two stamps of a frame
  SensorVector sensor = SensorVector::Zero();  // true parameters
  double max_depth_m = 5;
  uint64_t seed = 1;
};

/// A smooth path of 1 m radius, with the turn rates of a handheld camera (about 30 degrees per second).
inline SE3 path(double t) {
  const Eigen::Vector3d p(0.5 * std::sin(0.9 * t) + 0.1 * std::sin(3.1 * t), 0.15 * std::sin(1.7 * t + 1),
                          0.5 * std::cos(0.8 * t) + 0.1 * std::sin(2.3 * t));
  const Eigen::Vector3d turn(0.2 * std::sin(1.9 * t), 0.5 * std::sin(0.7 * t) + 0.15 * std::sin(2.9 * t + 2),
                             0.15 * std::sin(2.1 * t + 0.5));
  return {exp_so3(turn), p};
}

/// The velocity along the path.
inline Velocity path_velocity(double t) {
  constexpr double kStep_s = 1e-4;
  const SE3 T = path(t);
  Velocity velocity = velocity_between(path(t - kStep_s), path(t + kStep_s), 2 * kStep_s);
  velocity.linear_m_s = T.rotation.conjugate() *
                        ((path(t + kStep_s).translation - path(t - kStep_s).translation) / (2 * kStep_s));
  return velocity;
}

struct BundleWorld {
  BundleProblem problem;  // starts at the truth; see `perturb`
  std::vector<SE3> truth;
  std::vector<Eigen::Vector3d> points;
  std::vector<uint8_t> wrong;  // outlier observations
};

/// Observes a point at keyframe time t with the true sensor parameters.
inline bool observe(const BundleWorldSettings& settings, double t, const Eigen::Vector3d& p_world,
                    Random& random, BundleObservation& o) {
  // Only for settings without distortion.
  const PinholeCamera camera = corrected_camera({kinect(), {}, settings.sensor});
  Eigen::Vector3d p;
  for (int i = 0; i < 8; ++i) {  // row and time depend on each other
    p = path(t + settings.sensor(kRollingShutter) * o.row).inverse() * p_world;
    if (p.z() < 0.4) return false;
    o.row = camera.project(p).y() / camera.height - 0.5;
  }
  if (!camera.contains(camera.project(p)) || p.z() > settings.max_depth_m) return false;
  // In statements of their own: compilers differ in the order of arguments.
  const double noise_v = random.gaussian();
  const double noise_u = random.gaussian();
  o.pixel = camera.project(p) + settings.sigma_px * Eigen::Vector2d(noise_u, noise_v);
  o.sigma_px = settings.sigma_px > 0 ? settings.sigma_px : 1;
  const double depth_time =
      t + o.depth_stamp_difference_s + settings.sensor(kDepthShutter) * o.row + settings.sensor(kDepthDelay);
  const Eigen::Vector3d at_depth = path(depth_time).inverse() * p_world;
  const double inverse =
      (1 / at_depth.z() - settings.sensor(kInverseDepthBias)) / (1 + settings.sensor(kDepthScale)) +
      settings.sigma_inverse_depth * random.gaussian();
  if (random.uniform() < settings.depth_fraction) o.depth_m = 1 / inverse;
  return true;
}

/// Points on the walls, floor and ceiling of a room of 6 x 3 x 6 m.
inline Eigen::Vector3d random_wall_point(Random& random) {
  Eigen::Vector3d p;
  p.z() = random.uniform(0.8, 3.5);
  p.y() = random.uniform(-1.5, 1.5);
  p.x() = random.uniform(-3, 3);
  const uint32_t side = random.index(4);
  if (side == 0) p.x() = random.uniform() < 0.5 ? -2 : 2;
  if (side == 1) p.y() = random.uniform() < 0.5 ? -1.2 : 1.2;
  if (side == 2) p.z() = 3.5;
  return p;
}

inline BundleWorld make_bundle_world(const BundleWorldSettings& settings) {
  BundleWorld world;
  Random random(settings.seed);
  world.problem.sensor = kinect_sensor();
  for (int i = 0; i < settings.poses; ++i) {
    world.truth.push_back(path(i * settings.spacing_s));
    world.problem.velocities.push_back(path_velocity(i * settings.spacing_s));
  }
  world.problem.T_world_camera = world.truth;
  for (int j = 0; j < settings.points; ++j) {
    world.points.push_back(random_wall_point(random));
    for (int i = 0; i < settings.poses; ++i) {
      BundleObservation o;
      o.pose = static_cast<uint32_t>(i);
      o.point = static_cast<uint32_t>(j);
      o.depth_stamp_difference_s = settings.depth_stamp_difference_s * std::sin(2.5 * i);
      if (!observe(settings, i * settings.spacing_s, world.points.back(), random, o)) continue;
      const bool wrong = random.uniform() < settings.outlier_fraction;
      if (wrong) o.pixel = random_pixel(random, kinect());
      world.problem.observations.push_back(o);
      world.wrong.push_back(wrong);
    }
  }
  world.problem.p_world = world.points;
  world.problem.fixed.assign(world.truth.size(), 0);
  world.problem.fixed[0] = 1;
  return world;
}

/// Perturbs points and all poses that are not constant.
inline void perturb(BundleWorld& world, double size_m, double size_rad, uint64_t seed = 7) {
  Random random(seed);
  for (size_t i = 0; i < world.truth.size(); ++i) {
    if (world.problem.fixed[i] == 0)
      world.problem.T_world_camera[i] = world.truth[i] * random_motion(random, size_m, size_rad);
  }
  for (auto& p : world.problem.p_world) p += random_vector(random, size_m);
}

/// Root mean square of the position errors, m.
inline double position_error_m(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i)
    sum += (estimate[i].translation - truth[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

}  // namespace kinloop::test
