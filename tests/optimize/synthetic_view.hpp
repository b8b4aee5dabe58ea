#pragma once
// Random points observed by a camera: ground truth for tests of the pose solvers.

#include <cmath>
#include <limits>
#include <vector>

#include "kinloop/core/random.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop::test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline PinholeCamera kinect() {
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525;
  camera.fy = 524;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// An ideal sensor with that camera.
inline Sensor kinect_sensor() {
  return Sensor{kinect()};
}

inline Eigen::Vector3d random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

inline SE3 random_motion(Random& random, double size_m, double size_rad) {
  return {exp_so3(random_vector(random, size_rad)), random_vector(random, size_m)};
}

inline Eigen::Vector2d random_pixel(Random& random, const PinholeCamera& camera) {
  return {random.uniform(0, camera.width - 1), random.uniform(0, camera.height - 1)};
}

struct ViewNoise {
  double sigma_px = 0;
  double sigma_inverse_depth = 0;
  double depth_fraction = 0.7;    // fraction of the observations with depth
  double outlier_fraction = 0.0;  // fraction with a random pixel
};

/// Observations of random points between 0.7 and 4 m by a camera at T_reference_camera. Their sigma_px is the
/// value given to the solver, 1 for a noiseless view.
inline std::vector<PoseObservation> make_view(const SE3& T_reference_camera, int count,
                                              const ViewNoise& noise, Random& random) {
  const PinholeCamera camera = kinect();
  std::vector<PoseObservation> view;
  for (int i = 0; i < count; ++i) {
    PoseObservation o;
    const Eigen::Vector2d pixel = random_pixel(random, camera);
    const double depth_m = random.uniform(0.7, 4.0);
    o.p_reference = T_reference_camera * camera.unproject(pixel, depth_m);
    o.pixel = pixel + noise.sigma_px * gaussian_vector<2>(random);
    o.sigma_px = noise.sigma_px > 0 ? noise.sigma_px : 1;
    const double inverse = 1 / depth_m + noise.sigma_inverse_depth * random.gaussian();
    if (random.uniform() < noise.depth_fraction) o.depth_m = 1 / inverse;
    if (random.uniform() < noise.outlier_fraction) o.pixel = random_pixel(random, camera);
    view.push_back(o);
  }
  return view;
}

/// Twist from the estimate to the truth, in the frame of the estimate.
inline Vector6d error_of(const SE3& estimate, const SE3& truth) {
  return (estimate.inverse() * truth).log();
}

}  // namespace kinloop::test
