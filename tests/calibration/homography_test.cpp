#include "tools/calibration/board/homography.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibration/synthetic_boards.hpp"

namespace kinloop {
namespace {

using test::board_at;
using test::small_board;

PinholeCamera undistorted(PinholeCamera camera) {
  camera.lens = {};
  return camera;
}

std::vector<Eigen::Matrix3d> homographies_of(const std::vector<BoardView>& views) {
  std::vector<Eigen::Matrix3d> all;
  for (const auto& view : views) all.push_back(*fit_homography(view.board_m, view.pixels));
  return all;
}

TEST(Homography, MapsEveryPointWhereItWasSeen) {
  const auto views = test::random_views(undistorted(test::color_camera()), 20, 0, 1);
  for (const auto& view : views) {
    const Eigen::Matrix3d H = *fit_homography(view.board_m, view.pixels);
    EXPECT_NEAR(H.norm(), 1, 1e-12);
    for (size_t i = 0; i < view.pixels.size(); ++i) {
      const Eigen::Vector3d q = H * view.board_m[i].homogeneous();
      EXPECT_LT((q.hnormalized() - view.pixels[i]).norm(), 1e-8);
    }
  }
}

TEST(Homography, DoesNotDependOnUnitAndOrigin) {
  const auto view = test::random_views(undistorted(test::color_camera()), 1, 0.3, 2).front();
  auto moved = view.board_m;
  for (auto& p : moved) p = 1000 * p + Eigen::Vector2d(1e4, -3e4);
  const Eigen::Matrix3d H = *fit_homography(view.board_m, view.pixels),
                        G = *fit_homography(moved, view.pixels);
  for (size_t i = 0; i < moved.size(); ++i) {
    const Eigen::Vector3d a = H * view.board_m[i].homogeneous(), b = G * moved[i].homogeneous();
    EXPECT_LT((a.hnormalized() - b.hnormalized()).norm(), 1e-6);
  }
}

TEST(Homography, IsNothingWithoutAPlane) {
  const std::vector<Eigen::Vector2d> three = {{0, 0}, {1, 0}, {0, 1}};
  EXPECT_FALSE(fit_homography(three, three));
  std::vector<Eigen::Vector2d> line, pixels;
  for (int i = 0; i < 8; ++i) line.emplace_back(i, 2 * i), pixels.emplace_back(3 * i, i);
  EXPECT_FALSE(fit_homography(line, pixels));
  const std::vector<Eigen::Vector2d> same(8, Eigen::Vector2d(1, 2));
  EXPECT_FALSE(fit_homography(same, same));
}

TEST(ClosedForm, IsExactWithoutNoiseAndDistortion) {
  const PinholeCamera truth = undistorted(test::color_camera());
  for (const int count : {2, 3, 10}) {
    const auto camera =
        camera_from_homographies(homographies_of(test::random_views(truth, count, 0, 3)), 1920, 1080);
    ASSERT_TRUE(camera);
    EXPECT_NEAR(camera->fx, truth.fx, 1e-4);
    EXPECT_NEAR(camera->fy, truth.fy, 1e-4);
    EXPECT_NEAR(camera->cx, truth.cx, 1e-4);
    EXPECT_NEAR(camera->cy, truth.cy, 1e-4);
  }
}

TEST(ClosedForm, GivesBackThePosesOfTheBoards) {
  const PinholeCamera truth = undistorted(test::infrared_camera());
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const SE3 pose = test::random_pose(random, small_board());
    const auto found = board_pose(truth, test::view_of(truth, pose, small_board(), "v"));
    ASSERT_TRUE(found);
    EXPECT_LT((found->inverse() * pose).log().norm(), 1e-7);
  }
}

TEST(ClosedForm, TakesOutTheDistortionOfAKnownCamera) {
  const PinholeCamera camera = test::color_camera();
  const SE3 pose = board_at({0.1, -0.05, 0.5}, {0.4, -0.3, 0.1}, small_board());
  EXPECT_LT(
      (board_pose(camera, test::view_of(camera, pose, small_board(), "v"))->inverse() * pose).log().norm(),
      1e-6);
}

TEST(ClosedForm, IsNothingWhereAllBoardsAreParallel) {
  const PinholeCamera truth = undistorted(test::color_camera());
  std::vector<BoardView> views;
  for (int i = 0; i < 6; ++i) {
    views.push_back(test::view_of(
        truth, board_at({0.02 * i, 0.01 * i, 0.5 + 0.1 * i}, {0, 0, 0}, small_board()), small_board(), "v"));
  }
  EXPECT_FALSE(camera_from_homographies(homographies_of(views), 1920, 1080));
  EXPECT_FALSE(camera_from_homographies({}, 1920, 1080));
}

}  // namespace
}  // namespace kinloop
