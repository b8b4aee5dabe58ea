#include "tools/calibration/rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibration/synthetic_boards.hpp"
#include "tests/support/expect_error.hpp"
#include "tools/calibration/depth_shift.hpp"

namespace kinloop {
namespace {

using test::color_camera;
using test::infrared_camera;
using test::input_error;
using test::small_board;
using testing::HasSubstr;

SE3 true_motion() {
  return {exp_so3({0.01, -0.004, 0.002}), {-0.052, 0.0004, 0.001}};
}

std::vector<PairedView> random_pairs(int count, double sigma_px, uint64_t seed) {
  Random random(seed);
  std::vector<PairedView> pairs;
  for (int i = 0; i < count; ++i) {
    const SE3 T_infrared_board = test::random_pose(random, small_board());
    const std::string name = std::to_string(i);
    pairs.push_back(
        {test::view_of(color_camera(), true_motion() * T_infrared_board, small_board(), name + "_color"),
         test::view_of(infrared_camera(), T_infrared_board, small_board(), name + "_ir")});
    test::add_noise(pairs.back().color, sigma_px, random);
    test::add_noise(pairs.back().infrared, sigma_px / 2, random);
  }
  return pairs;
}

double squared_deviations(const RigCalibration& rig) {
  Vector6d error;
  error << rig.T_color_infrared.translation - true_motion().translation,
      log_so3(rig.T_color_infrared.rotation) - log_so3(true_motion().rotation);
  return error.dot(rig.extrinsics_covariance.ldlt().solve(error));
}

TEST(CalibrateRig, FindsLensesAndMotionWithoutNoise) {
  const RigCalibration rig = calibrate_rig(random_pairs(12, 0, 1), {}, {}, small_board());
  EXPECT_LT((rig.T_color_infrared.inverse() * true_motion()).log().norm(), 1e-7);
  EXPECT_NEAR(rig.color.fx, color_camera().fx, 1e-4);
  EXPECT_NEAR(rig.infrared.fx, infrared_camera().fx, 1e-4);
}

TEST(CalibrateRig, KeepsLensesAndMotionThatAreKnown) {
  const auto pairs = random_pairs(6, 0.1, 2);
  const RigCalibration rig =
      calibrate_rig(pairs, {color_camera(), {}}, {infrared_camera(), {}}, small_board());
  EXPECT_EQ(rig.color.fx, color_camera().fx);
  EXPECT_EQ(rig.infrared.lens.k2, infrared_camera().lens.k2);
  EXPECT_EQ(rig.color_covariance.norm(), 0);
  EXPECT_LT((rig.T_color_infrared.translation - true_motion().translation).norm(), 1e-3);
  const RigCalibration held =
      calibrate_rig(pairs, {color_camera(), {}}, {infrared_camera(), {}}, small_board(), {}, true_motion());
  EXPECT_LT((held.T_color_infrared.inverse() * true_motion()).log().norm(), 1e-12);
}

TEST(CalibrateRig, StillsOfOneCameraHelpTheOther) {
  const auto pairs = random_pairs(5, 0.2, 3);
  const RigCalibration alone = calibrate_rig(pairs, {}, {}, small_board());
  const RigCalibration helped =
      calibrate_rig(pairs, {{}, test::random_views(color_camera(), 40, 0.2, 4)}, {}, small_board());
  EXPECT_LT(helped.infrared_covariance(0, 0), alone.infrared_covariance(0, 0) / 1.5);
}

TEST(CalibrateRig, TheCovarianceIsThatOfTheErrors) {
  constexpr int kTrials = 30;
  double sum = 0;
  for (uint64_t seed = 0; seed < kTrials; ++seed) {
    sum +=
        squared_deviations(calibrate_rig(random_pairs(12, 0.2, 50 + seed), {}, {}, small_board())) / kTrials;
  }
  EXPECT_LT(sum, 6 + 2.5);
  EXPECT_GT(sum, 6 * 0.4);
}

TEST(CalibrateRig, ResolvesBoardSymmetry) {
  auto pairs = random_pairs(8, 0.1, 5);
  for (size_t i = 0; i < pairs.size(); i += 2) {
    std::reverse(pairs[i].color.pixels.begin(), pairs[i].color.pixels.end());
  }
  const RigCalibration rig = calibrate_rig(pairs, {}, {}, small_board());
  EXPECT_TRUE(rig.rejected.empty());
  EXPECT_LT((rig.T_color_infrared.translation - true_motion().translation).norm(), 3e-3);
}

TEST(CalibrateRig, NamesThePairInWhichTheCameraMovedBetweenTheImages) {
  auto pairs = random_pairs(10, 0.1, 6);
  for (auto& pixel : pairs[4].color.pixels) pixel += Eigen::Vector2d(12, -7);
  const RigCalibration rig =
      calibrate_rig(pairs, {color_camera(), {}}, {infrared_camera(), {}}, small_board());
  ASSERT_EQ(rig.rejected.size(), 1U);
  EXPECT_EQ(rig.rejected[0].name, "4_color");
  EXPECT_THAT(rig.rejected[0].reason, HasSubstr("transform of the other pairs"));
}

TEST(CalibrateRig, NeedsTwoPairs) {
  EXPECT_THAT(input_error([] { calibrate_rig(random_pairs(1, 0, 1), {}, {}, small_board()); }),
              HasSubstr("only 1"));
}

/// Depth of the plane of the board, too small by `less_m`.
cv::Mat depth_of(const SE3& T_depth_board, double less_m, double noise_m, uint64_t seed) {
  const PinholeCamera camera = infrared_camera();
  Random random(seed);
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  const Eigen::Vector3d normal = T_depth_board.R().col(2);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const Eigen::Vector3d ray = camera.unproject(camera.undistort(Eigen::Vector2d(x, y)), 1);
      const double z = normal.dot(T_depth_board.translation) / normal.dot(ray);
      depth.at<float>(y, x) = static_cast<float>(z - less_m + noise_m * random.gaussian());
    }
  }
  return depth;
}

std::vector<BoardDepthView> board_depth_views(double less_m, double noise_m) {
  Random random(7);
  std::vector<BoardDepthView> boards;
  for (int i = 0; i < 6; ++i) {
    const SE3 pose = test::random_pose(random, small_board());
    boards.push_back(
        {std::to_string(i), pose, depth_of(pose, less_m, noise_m, 100 + static_cast<uint64_t>(i))});
  }
  return boards;
}

TEST(DepthShift, IsWhatThePlaneIsFartherThanMeasured) {
  const DepthShift exact =
      estimate_depth_shift(board_depth_views(0.025, 0), infrared_camera(), small_board());
  EXPECT_NEAR(exact.shift_m, 0.025, 1e-6);
  EXPECT_NEAR(exact.slope, 0, 1e-5);
  const DepthShift noisy =
      estimate_depth_shift(board_depth_views(-0.01, 0.005), infrared_camera(), small_board());
  EXPECT_NEAR(noisy.shift_m, -0.01, 4e-4);
  EXPECT_NEAR(noisy.boards.front().spread_m, 0.005, 5e-4);
  EXPECT_LT(std::abs(noisy.shift_m + 0.01), 4 * noisy.sigma_m);
}

TEST(DepthShift, IncludesTheUncertaintyOfTheFocalLength) {
  const auto boards = board_depth_views(0.025, 0.002);
  const DepthShift sure = estimate_depth_shift(boards, infrared_camera(), small_board());
  const DepthShift unsure = estimate_depth_shift(boards, infrared_camera(), small_board(), 0.01);
  EXPECT_LT(sure.sigma_m, 0.001);
  EXPECT_GT(unsure.sigma_m, 0.004);
}

TEST(DepthShift, LeavesOutUnknownDepthAndRefusesNoneAtAll) {
  auto boards = board_depth_views(0.02, 0);
  boards[0].depth_m.setTo(0);
  boards[1].depth_m.colRange(0, boards[1].depth_m.cols / 2).setTo(0);
  const DepthShift shift = estimate_depth_shift(boards, infrared_camera(), small_board());
  EXPECT_LE(shift.boards.size(), 5U);
  EXPECT_NEAR(shift.shift_m, 0.02, 1e-6);
  for (auto& b : boards) b.depth_m.setTo(0);
  EXPECT_THAT(input_error([&] { estimate_depth_shift(boards, infrared_camera(), small_board()); }),
              HasSubstr("no board has depth"));
}

}  // namespace
}  // namespace kinloop
