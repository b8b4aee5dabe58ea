
#include <gtest/gtest.h>

#include "kinloop/mapping/landmark_creation.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::camera_at;

constexpr double kSigma_rad = 0.001;

Bearing make_bearing(const Eigen::Vector3d& p_camera) {
  return {p_camera.normalized(), kSigma_rad};
}

TEST(Triangulate, FindsThePointWhereRaysMeet) {
  const SE3 T_a_b = camera_at(-0.1, {0.3, 0.05, 0.02});
  const Eigen::Vector3d p_a(0.4, -0.2, 3);
  const auto found = triangulate(make_bearing(p_a), make_bearing(T_a_b.inverse() * p_a), T_a_b, 0.02);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - p_a).norm(), 1e-12);
}

TEST(Triangulate, RejectsRaysFartherApartThanTheirNoise) {
  const SE3 T_a_b = camera_at(0, {0.3, 0, 0});
  const Eigen::Vector3d p_a(0, 0, 3);
  const auto off_by = [&](double angle_rad) {
    const Eigen::Vector3d raised = exp_so3({angle_rad, 0, 0}) * Eigen::Vector3d(T_a_b.inverse() * p_a);
    return triangulate(make_bearing(p_a), make_bearing(raised), T_a_b, 0.02);
  };
  ASSERT_TRUE(off_by(kSigma_rad));
  EXPECT_LT((*off_by(kSigma_rad) - p_a).norm(), 0.004);
  EXPECT_FALSE(off_by(5 * kSigma_rad));
}

TEST(Triangulate, RejectsDegenerateRays) {
  const Eigen::Vector3d p_a(0, 0, 30);
  const SE3 T_a_b = camera_at(0, {0.1, 0, 0});
  // Too far apart.
  EXPECT_FALSE(triangulate(make_bearing(p_a), make_bearing(T_a_b.inverse() * p_a), T_a_b, 0.02));
  EXPECT_FALSE(triangulate(make_bearing({0.5, 0, 1}), make_bearing({-0.5, 0, 1}), camera_at(0, {-1, 0, 0}),
                           0.02));                                               // behind the camera
  EXPECT_FALSE(triangulate(make_bearing(p_a), make_bearing(p_a), SE3{}, 0.02));  // no baseline
}

TEST(Triangulate, TriangulatesLandmarksWithoutDepth) {
  const auto world = test::make_world(2500, 1);
  test::SyntheticMap built;
  const test::ObservationNoise half_without_depth{0.3, 1.425e-3, 8, 0.5};
  const auto first = test::observe(world, SE3{}, half_without_depth, 2);
  test::add_view(built, world, first, SE3{});
  const SE3 pose = camera_at(0.05, {0.25, 0.02, 0});
  const auto second = test::observe(world, pose, half_without_depth, 3);
  const KeyframeId id = test::add_view(built, world, second, pose);

  const int grown = triangulate_landmarks(built.map, id, world.camera, {});
  EXPECT_GT(grown, 20);
  int wrong = 0;
  for (uint32_t i = 0; i < second.point_of.size(); ++i) {
    const LandmarkId landmark = built.map.keyframe(id).landmark_of[i];
    if (!landmark.valid() || second.features->depths_m[i] > 0) continue;
    const Eigen::Vector3d& truth = world.p_world[second.point_of[i]];
    wrong += (built.map.p_world(landmark) - truth).norm() > 0.25 ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  built.map.check_invariants();
  // Each keypoint gets only one landmark.
  EXPECT_EQ(triangulate_landmarks(built.map, id, world.camera, {}), 0);
}

}  // namespace
}  // namespace kinloop
