#include "kinloop/mapping/triangulate.hpp"

#include <gtest/gtest.h>

#include "kinloop/mapping/grow.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::looking;

constexpr double kSigma_rad = 0.001;

Sight sight_of(const Eigen::Vector3d& p_camera) {
  return {p_camera.normalized(), kSigma_rad};
}

TEST(Triangulate, FindsThePointWhereRaysMeet) {
  const SE3 T_a_b = looking(-0.1, {0.3, 0.05, 0.02});
  const Eigen::Vector3d p_a(0.4, -0.2, 3);
  const auto found = triangulate(sight_of(p_a), sight_of(T_a_b.inverse() * p_a), T_a_b, 0.02);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - p_a).norm(), 1e-12);
}

TEST(Triangulate, TakesRaysThatMissEachOtherByTheirNoiseOnly) {
  const SE3 T_a_b = looking(0, {0.3, 0, 0});
  const Eigen::Vector3d p_a(0, 0, 3);
  const auto off_by = [&](double angle_rad) {
    const Eigen::Vector3d raised = exp_so3({angle_rad, 0, 0}) * Eigen::Vector3d(T_a_b.inverse() * p_a);
    return triangulate(sight_of(p_a), sight_of(raised), T_a_b, 0.02);
  };
  ASSERT_TRUE(off_by(kSigma_rad));
  EXPECT_LT((*off_by(kSigma_rad) - p_a).norm(), 0.01);
  EXPECT_FALSE(off_by(5 * kSigma_rad));
}

TEST(Triangulate, RefusesWhatCannotBeTold) {
  const Eigen::Vector3d p_a(0, 0, 30);
  const SE3 T_a_b = looking(0, {0.1, 0, 0});
  EXPECT_FALSE(triangulate(sight_of(p_a), sight_of(T_a_b.inverse() * p_a), T_a_b, 0.02));  // too far
  EXPECT_FALSE(
      triangulate(sight_of({0.5, 0, 1}), sight_of({-0.5, 0, 1}), looking(0, {-1, 0, 0}), 0.02));  // behind
  EXPECT_FALSE(triangulate(sight_of(p_a), sight_of(p_a), SE3{}, 0.02));  // no baseline
}

TEST(Triangulate, GrowsLandmarksWhereDepthIsMissing) {
  const auto world = test::make_world(2500, 1);
  test::SyntheticMap built;
  const test::ObservationNoise half_blind{0.3, 1.425e-3, 8, 0.5};
  const auto first = test::observe(world, SE3{}, half_blind, 2);
  test::add_view(built, world, first, SE3{});
  const SE3 pose = looking(0.05, {0.25, 0.02, 0});
  const auto second = test::observe(world, pose, half_blind, 3);
  const KeyframeId id = test::add_view(built, world, second, pose);

  const int grown = grow_from_parallax(built.map, id, world.camera, {});
  EXPECT_GT(grown, 20);
  int wrong = 0;
  for (uint32_t i = 0; i < second.point_of.size(); ++i) {
    const LandmarkId landmark = built.map.keyframe(id).landmark_of[i];
    if (!landmark.valid() || second.features->depths_m[i] > 0) continue;
    const Eigen::Vector3d& truth = world.p_world[second.point_of[i]];
    wrong += (built.map.p_world(landmark) - truth).norm() > 0.25 ? 1 : 0;
  }
  EXPECT_LE(wrong, grown / 20);
  built.map.check_invariants();
  EXPECT_EQ(grow_from_parallax(built.map, id, world.camera, {}), 0);  // each key point only once
}

}  // namespace
}  // namespace kinloop
