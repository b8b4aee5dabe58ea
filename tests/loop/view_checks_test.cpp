#include "kinloop/loop/verification/view_checks.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/loop/room_views.hpp"
#include "tests/loop/wall_view.hpp"
#include "tests/sensor/vga_surfaces.hpp"
#include "tests/support/random_vectors.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using test::camera_at;

constexpr double kPositionSigma_m = 0.02;
constexpr double kMaxShare = 0.005;

/// A wall across the view and a board in front of it, both perpendicular to z.
struct Scene {
  double wall_m = 3;
  double board_m = 1.5;
  double board_half_width_m = 0.4, board_half_height_m = 0.3;
};

/// Returns z of the first surface hit by a ray from `origin`, in the world frame.
double surface_met(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d at_board = origin + ray * ((scene.board_m - origin.z()) / ray.z());
  const bool on_board =
      std::abs(at_board.x()) < scene.board_half_width_m && std::abs(at_board.y()) < scene.board_half_height_m;
  return on_board ? scene.board_m : scene.wall_m;
}

/// Simulates keypoints all over the image with sensor noise and depth gradients as in
/// `inverse_depth_gradient`.
Features seen(const Scene& scene, const PinholeCamera& camera, const SE3& T_world_camera, uint64_t seed) {
  constexpr int kCount = 800;
  constexpr double kReach_px = 8;
  Features features;
  Random random(seed);
  const auto depth_of = [&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector3d ray = T_world_camera.rotation * camera.unproject(pixel, 1);
    const double z = surface_met(scene, T_world_camera.translation, ray);
    return (z - T_world_camera.translation.z()) / ray.z();
  };
  const auto inverse_slope = [&](const Eigen::Vector2d& pixel, const Eigen::Vector2d& step) {
    return (1 / depth_of(pixel + step) - 1 / depth_of(pixel - step)) / (2 * step.norm());
  };
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector2d pixel =
        test::uniform_vector<2>(random, {0, 0}, {camera.width - 1, camera.height - 1});
    const double noise = DepthNoise{}.coefficient_per_m * random.gaussian();
    features.pixels.push_back(pixel.cast<float>());
    features.depths_m.push_back(static_cast<float>(1 / (1 / depth_of(pixel) + noise)));
    Eigen::Vector2d slope(inverse_slope(pixel, {kReach_px, 0}), inverse_slope(pixel, {0, kReach_px}));
    constexpr double kEdge = 0.005;  // 1/m per px
    if (slope.norm() > kEdge) slope.setConstant(std::numeric_limits<double>::quiet_NaN());
    features.inverse_depth_gradients.push_back(slope.cast<float>());
    features.levels.push_back(0);
  }
  return features;
}

class DepthCheck : public testing::Test {
 protected:
  /// Compares views of two scenes as if they were one.
  DepthConsistency compare(const Scene& scene_a, const SE3& T_world_a, const Scene& scene_b,
                           const SE3& T_world_b, const SE3& error = {}) const {
    return compare_depths({seen(scene_a, camera_, T_world_a, 1)}, {seen(scene_b, camera_, T_world_b, 2)},
                          T_world_a.inverse() * T_world_b * error, Sensor{camera_}, kPositionSigma_m);
  }

  PinholeCamera camera_ = test::make_world(0, 1).camera;
  Scene scene_;
  SE3 T_world_a_ = camera_at(0.1, {-0.2, 0, 0});
  SE3 T_world_b_ = camera_at(-0.15, {0.2, 0.1, 0.1});
};

TEST_F(DepthCheck, OneSceneAgreesWithItself) {
  const auto depths = compare(scene_, T_world_a_, scene_, T_world_b_);
  EXPECT_GT(depths.consistent, 300);
  EXPECT_EQ(depths.free_space_violations, 0);
}

TEST_F(DepthCheck, ASmallPoseErrorIsNoViolation) {
  const SE3 error = camera_at(0.01, {0.02, 0.01, -0.02});
  EXPECT_FALSE(contradicts_free_space(compare(scene_, T_world_a_, scene_, T_world_b_, error), kMaxShare));
}

TEST_F(DepthCheck, AMovedWallViolatesFreeSpace) {
  for (const double wall_m : {2.6, 3.4}) {
    Scene other = scene_;
    other.wall_m = wall_m;
    const auto depths = compare(scene_, T_world_a_, other, T_world_b_);
    EXPECT_GT(depths.consistent, 120) << "the board is the same";
    EXPECT_TRUE(contradicts_free_space(depths, kMaxShare)) << wall_m;
  }
}

TEST_F(DepthCheck, OcclusionIsNoViolation) {
  // Each view shows part of the wall that the board occludes in the other.
  const SE3 left = camera_at(0.3, {-0.9, 0, 0}), right = camera_at(-0.3, {0.9, 0, 0});
  const auto depths = compare(scene_, left, scene_, right);
  EXPECT_GT(depths.consistent, 300);
  EXPECT_FALSE(contradicts_free_space(depths, kMaxShare));
  Scene without = scene_;
  without.board_half_width_m = 0;
  const auto bare = compare(without, left, without, right);
  EXPECT_GT(bare.consistent, depths.consistent) << "nothing was occluded: nothing is tested";
}

TEST_F(DepthCheck, AnObjectInOneViewOnlyViolatesFreeSpace) {
  Scene without = scene_;
  without.board_half_width_m = 0;
  EXPECT_TRUE(contradicts_free_space(compare(scene_, T_world_a_, without, T_world_b_), kMaxShare));
  EXPECT_TRUE(contradicts_free_space(compare(without, T_world_a_, scene_, T_world_b_), kMaxShare));
}

TEST_F(DepthCheck, IsSymmetric) {
  Scene other = scene_;
  other.wall_m = 3.4;
  const Features a = seen(scene_, camera_, T_world_a_, 1), b = seen(other, camera_, T_world_b_, 2);
  const SE3 T_a_b = T_world_a_.inverse() * T_world_b_;
  const auto forth = compare_depths({a}, {b}, T_a_b, Sensor{camera_}, kPositionSigma_m);
  const auto back = compare_depths({b}, {a}, T_a_b.inverse(), Sensor{camera_}, kPositionSigma_m);
  EXPECT_EQ(forth.free_space_violations, back.free_space_violations);
  EXPECT_EQ(forth.consistent, back.consistent);
}

TEST_F(DepthCheck, WithoutDepthNothingIsCompared) {
  Features a = seen(scene_, camera_, T_world_a_, 1);
  a.inverse_depth_gradients.clear();
  Features b = seen({2.6}, camera_, T_world_b_, 2);
  b.depths_m.assign(b.size(), 0);
  const auto depths =
      compare_depths({a}, {b}, T_world_a_.inverse() * T_world_b_, Sensor{camera_}, kPositionSigma_m);
  EXPECT_EQ(depths.consistent + depths.free_space_violations, 0);
  EXPECT_FALSE(contradicts_free_space(depths, 0));
}

TEST_F(DepthCheck, AFewOutliersAreTolerated) {
  EXPECT_FALSE(contradicts_free_space({10, 2}, kMaxShare));
  EXPECT_TRUE(contradicts_free_space({10, 3}, kMaxShare));
  EXPECT_FALSE(contradicts_free_space({1000, 5}, kMaxShare));
  EXPECT_TRUE(contradicts_free_space({1000, 6}, kMaxShare));
}

constexpr double kUnlikely = 1e-3;

class AppearanceCheck : public test::RoomViews {
 protected:
  [[nodiscard]] double chance() const {
    return appearance_p_value({a_}, {b_}, T_world_a_.inverse() * T_world_b_, world_.camera);
  }
};

TEST_F(AppearanceCheck, SameSceneHasAHighPValue) {
  ASSERT_GT(a_.size(), 500U);
  EXPECT_GT(chance(), 0.5);
}

TEST_F(AppearanceCheck, DifferentTextureHasALowPValue) {
  Random random(3);
  in_window(250, [&](int row) { repaint(row, random); });
  EXPECT_LT(chance(), kUnlikely);
  std::swap(a_, b_);
  std::swap(T_world_a_, T_world_b_);
  EXPECT_LT(chance(), kUnlikely) << "the other way around";
}

TEST_F(AppearanceCheck, ASmallChangeIsTolerated) {
  Random random(3);
  in_window(80, [&](int row) { repaint(row, random); });
  EXPECT_GT(chance(), kUnlikely);
}

TEST_F(AppearanceCheck, UniformlyLowRepeatabilityIsTolerated) {
  Random random(4);
  for (int row = 0; row < b_.descriptors.rows; ++row) {
    if (random.uniform() < 0.6) repaint(row, random);
  }
  EXPECT_GT(chance(), kUnlikely) << "as with blur";
}

TEST_F(AppearanceCheck, OcclusionIsTolerated) {
  Random random(5);
  in_window(250, [&](int row) {
    repaint(row, random);
    b_.depths_m[static_cast<size_t>(row)] = 0.6F;
  });
  EXPECT_GT(chance(), kUnlikely);
}

TEST_F(AppearanceCheck, TooFewKeypointsGiveAPValueOfOne) {
  EXPECT_EQ(appearance_p_value({a_}, {Features{}}, {}, world_.camera), 1);
  a_.depths_m.assign(a_.size(), 0);
  b_.depths_m.assign(b_.size(), 0);
  EXPECT_EQ(chance(), 1);
}

TEST(DepthCheckOfSurfaces, WhatMovesDoesNotViolateFreeSpace) {
  const PinholeCamera& pinhole = test::vga_camera();
  const cv::Mat nothing_m(480, 640, CV_32FC1, cv::Scalar(0));
  const SurfaceGrid moving = make_surface_grid(test::vga_surface_camera(), nothing_m);
  const Features wall = *test::painted_wall_view(2), person = *test::painted_wall_view(1.5);
  const auto violations = [&](const View& of_person) {
    return compare_depths({wall}, of_person, {}, Sensor{pinhole}, kPositionSigma_m).free_space_violations;
  };
  EXPECT_GT(violations({person}), 100);
  EXPECT_EQ(violations({person, &moving}), 0);
}

TEST(AppearanceCheckOfSurfaces, WhatHasMovedDoesNotCount) {
  const auto camera = test::vga_surface_camera();
  const PinholeCamera& pinhole = test::vga_camera();
  const cv::Mat wall_m(480, 640, CV_32FC1, cv::Scalar(2));
  const SurfaceGrid wall = make_surface_grid(camera, wall_m);
  cv::Mat lower_m = wall_m.clone();
  lower_m(cv::Rect(0, 0, 640, 240)) = 0;
  const SurfaceGrid lower = make_surface_grid(camera, lower_m);
  const Features a = *test::painted_wall_view(2);
  Features b = a;
  b.descriptors = a.descriptors.clone();
  test::repaint(b);
  EXPECT_LT(appearance_p_value({a}, {b}, {}, pinhole), kUnlikely);
  EXPECT_LT(appearance_p_value({a, &wall}, {b, &wall}, {}, pinhole), kUnlikely);
  EXPECT_GT(appearance_p_value({a, &wall}, {b, &lower}, {}, pinhole), kUnlikely) << "a person stands there";
  EXPECT_GT(appearance_p_value({a, &lower}, {b, &wall}, {}, pinhole), kUnlikely) << "or stood there before";
}

TEST(AppearanceTally, DifferByAppearanceOrByAKnownSize) {
  const auto is_different = [](const ViewComparison& views) {
    AppearanceTally tally;
    tally.add(views);
    return tally.different_views == 1;
  };
  EXPECT_TRUE(is_different({1e-4, {1, 0.002}}));
  EXPECT_TRUE(is_different({1, {0.98, 0.002}}));
  EXPECT_TRUE(is_different({1, {1.02, 0.002}}));
  EXPECT_FALSE(is_different({1, {1.01, 0.002}})) << "as depth sensors err from afar";
  EXPECT_FALSE(is_different({1, {0.98, 0.01}})) << "within three sigma";
  EXPECT_FALSE(is_different({1, {}})) << "unknown";
}

}  // namespace
}  // namespace kinloop
