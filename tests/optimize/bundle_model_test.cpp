#include "kinloop/optimize/bundle/bundle_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/optimize/synthetic_view.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using test::random_motion;
using test::random_vector;

/// A residual with every effect enabled, so that no derivative is zero.
struct Sample {
  Sensor sensor = test::kinect_sensor();
  KeypointMeasurement observation;
  SE3 T_world_camera;
  Velocity velocity;
  Eigen::Vector3d p_world;

  explicit Sample(Random& random) {
    T_world_camera = random_motion(random, 1, 1);
    velocity = {random_vector(random, 1), random_vector(random, 2)};
    const Eigen::Vector3d p_camera = test::uniform_vector<3>(random, {-1, -1, 1}, {1, 1, 3});
    p_world = T_world_camera * p_camera;
    observation.pixel = sensor.camera.project(p_camera) + Eigen::Vector2d(3, -2);
    observation.depth_m = p_camera.z() + 0.02;
    observation.sigma_px = 1.3;
    observation.row = random.uniform(-0.5, 0.5);
    observation.depth_stamp_difference_s = random.uniform(-0.02, 0.02);
    observation.inverse_depth_gradient = {random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3)};
    sensor.corrections << 5, -3, 1, 2, 0.05, -0.03, 0.03, 0.015, 0.02, 0.01, 0.002, 0.001, -0.001, 0.003,
        0.002, -0.002;
  }

  [[nodiscard]] LinearizedObservation linear() const {
    return linearize_observation(sensor, observation, BundleUse::kPixelAndDepth, {T_world_camera, velocity},
                                 p_world);
  }
  [[nodiscard]] Eigen::Vector3d error() const { return linear().e; }
};

/// Central difference of the residual under a change of the sample.
template <class Change>
Eigen::Vector3d difference(const Sample& sample, double step, const Change& change) {
  Sample up = sample, down = sample;
  change(up, step);
  change(down, -step);
  return (up.error() - down.error()) / (2 * step);
}

void expect_near(const Eigen::Vector3d& analytic, const Eigen::Vector3d& numeric, const char* what,
                 int column) {
  EXPECT_LT((analytic - numeric).norm(), 1e-5 * (1 + numeric.norm())) << what << " " << column;
}

TEST(BundleModel, AnalyticDerivativesMatchNumericOnes) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Sample sample(random);
    const LinearizedObservation J = sample.linear();
    for (int i = 0; i < 6; ++i) {
      const auto turn = [&](Sample& s, double h) {
        s.T_world_camera = s.T_world_camera * SE3::exp(h * Vector6d::Unit(i));
      };
      expect_near(J.J_pose.col(i), difference(sample, 1e-6, turn), "pose", i);
      const auto faster = [&](Sample& s, double h) {
        s.velocity = Velocity::from_vector(s.velocity.vector() + h * Vector6d::Unit(i));
      };
      expect_near(J.J_velocity.col(i), difference(sample, 1e-4, faster), "velocity", i);
    }
    for (int i = 0; i < 3; ++i) {
      const auto shift = [&](Sample& s, double h) { s.p_world(i) += h; };
      expect_near(J.J_point.col(i), difference(sample, 1e-6, shift), "point", i);
    }
    for (int i = 0; i < kSensorParameterCount; ++i) {
      const auto correct = [&](Sample& s, double h) { s.sensor.corrections(i) += h; };
      expect_near(J.J_sensor.col(i), difference(sample, 1e-5, correct), "sensor", i);
    }
  }
}

TEST(BundleModel, ObservationsWithoutDepthHaveNoDepthRow) {
  Random random(2);
  const Sample sample(random);
  const auto linear = linearize_observation(sample.sensor, sample.observation, BundleUse::kPixel,
                                            {sample.T_world_camera, sample.velocity}, sample.p_world);
  EXPECT_EQ(linear.e.z(), 0);
  EXPECT_TRUE(linear.J_pose.row(2).isZero(0));
  EXPECT_TRUE(linear.J_velocity.row(2).isZero(0));
  EXPECT_TRUE(linear.J_point.row(2).isZero(0));
  EXPECT_TRUE(linear.J_sensor.row(2).isZero(0));
}

}  // namespace
}  // namespace kinloop
