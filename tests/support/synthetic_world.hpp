#pragma once
// A room of points with descriptors, seen by a camera: ground truth for tests of the modules from features
// upwards.

#include <memory>
#include <vector>

#include "kinloop/core/random.hpp"
#include "kinloop/features/features.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"
#include "tests/support/pinhole_cameras.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop::test {

struct SyntheticWorld {
  PinholeCamera camera;
  std::vector<Eigen::Vector3d> p_world;  // m
  cv::Mat descriptors;                   // one row per point
};

/// `count` points on the walls of a 4 x 3 x 4 m box around the origin, with random descriptors.
inline SyntheticWorld make_world(uint32_t count, uint64_t seed) {
  SyntheticWorld world;
  world.camera = vga_camera();
  world.descriptors.create(static_cast<int>(count), kOrbBytes, CV_8UC1);
  Random random(seed);
  const Eigen::Vector3d half(2.0, 1.5, 2.0);
  for (uint32_t i = 0; i < count; ++i) {
    Eigen::Vector3d point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = random.uniform(-half[axis], half[axis]);
    const uint32_t wall = random.index(6);
    point[wall / 2] = wall % 2 == 0 ? half[wall / 2] : -half[wall / 2];
    world.p_world.push_back(point);
    for (int b = 0; b < kOrbBytes; ++b) {
      world.descriptors.at<uint8_t>(static_cast<int>(i), b) = static_cast<uint8_t>(random.next());
    }
  }
  return world;
}

struct ObservationNoise {
  double sigma_px = 0.5;
  double sigma_inverse_depth = 1.425e-3;  // 1/m
  int flipped_bits = 12;
  double missing_depth_fraction = 0.2;
};

/// An image of the world, with the point that each keypoint observes.
struct SyntheticView {
  std::shared_ptr<const Features> features;
  std::vector<uint32_t> point_of;
};

inline SyntheticView observe(const SyntheticWorld& world, const SE3& T_world_camera,
                             const ObservationNoise& noise, uint64_t seed) {
  Features features;
  SyntheticView view;
  Random random(seed);
  const SE3 T_camera_world = T_world_camera.inverse();
  for (uint32_t i = 0; i < world.p_world.size(); ++i) {
    const Eigen::Vector3d p_camera = T_camera_world * world.p_world[i];
    if (p_camera.z() < 0.4) continue;
    const Eigen::Vector2d jitter = gaussian_vector<2>(random);
    const Eigen::Vector2d pixel = world.camera.project(p_camera) + noise.sigma_px * jitter;
    if (!world.camera.contains(pixel, 1)) continue;
    const double inverse_depth = 1 / p_camera.z() + noise.sigma_inverse_depth * random.gaussian();
    features.pixels.push_back(pixel.cast<float>());
    features.raw_pixels.push_back(pixel.cast<float>());
    features.depths_m.push_back(
        random.uniform() < noise.missing_depth_fraction ? 0 : static_cast<float>(1 / inverse_depth));
    features.measured_pixels.push_back(features.pixels.back());
    features.measured_depths_m.push_back(features.depths_m.back());
    features.levels.push_back(0);
    features.angles_rad.push_back(0);
    features.sigmas_px.push_back(1);
    cv::Mat descriptor = world.descriptors.row(static_cast<int>(i)).clone();
    for (int flip = 0; flip < noise.flipped_bits; ++flip) {
      const uint32_t bit = random.index(256);
      descriptor.at<uint8_t>(static_cast<int>(bit / 8)) ^= static_cast<uint8_t>(1U << (bit % 8));
    }
    features.descriptors.push_back(descriptor);
    view.point_of.push_back(i);
  }
  view.features = std::make_shared<const Features>(std::move(features));
  return view;
}

/// Rotation about the camera's vertical axis, then a position.
inline SE3 camera_at(double yaw_rad, const Eigen::Vector3d& position) {
  return {exp_so3(Eigen::Vector3d(0, yaw_rad, 0)), position};
}

/// The i-th of true poses along a short arc.
inline SE3 pose_on_arc(int i) {
  return camera_at(0.08 * i, {0.06 * i, 0.01 * (i % 3), -0.03 * i});
}

/// Distance between two poses, m.
inline double distance_m(const SE3& a, const SE3& b) {
  return (a.translation - b.translation).norm();
}
inline double angle_rad(const SE3& a, const SE3& b) {
  return (a.inverse() * b).angle_rad();
}

}  // namespace kinloop::test
