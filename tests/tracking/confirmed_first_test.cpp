#include "kinloop/tracking/evidence/confirmed_first.hpp"

#include <gtest/gtest.h>

#include "tests/optimize/synthetic_view.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kinect_sensor;
using test::make_view;

/// Points of the room, and of something that moves through it.
class ConfirmedFirst : public testing::Test {
 protected:
  ConfirmedFirst() {
    const test::ViewNoise noise{.sigma_px = 0.5, .sigma_inverse_depth = 0.002};
    truth_ = test::random_motion(random_, 0.05, 0.02);
    const SE3 moved = truth_ * SE3{Eigen::Quaterniond::Identity(), {0.03, 0, 0}};
    room_ = make_view(truth_, 60, noise, random_);
    thing_ = make_view(moved, 300, noise, random_);
  }

  [[nodiscard]] std::optional<VotedPose> solve(size_t confirmed_count) const {
    std::vector<PoseObservation> all = room_;
    all.insert(all.end(), thing_.begin(), thing_.end());
    std::vector<bool> confirmed(all.size(), false);
    std::fill_n(confirmed.begin(), confirmed_count, true);
    return solve_by_confirmed_first(kinect_sensor(), all, confirmed, SE3{}, {});
  }

  Random random_{3};
  SE3 truth_;
  std::vector<PoseObservation> room_, thing_;
};

TEST_F(ConfirmedFirst, OldLandmarksPrevailOverManyNewOnes) {
  const auto pose = solve(60);
  ASSERT_TRUE(pose);
  EXPECT_LT(error_of(pose->T_reference_camera, truth_).head<3>().norm(), 0.005);
  EXPECT_EQ(pose->voters, 60);
  EXPECT_EQ(std::count(pose->inliers.begin() + 60, pose->inliers.end(), 1), 0);
  EXPECT_EQ(std::count(pose->inliers.begin(), pose->inliers.end(), 1), pose->inlier_count);
}

TEST_F(ConfirmedFirst, TooFewOfThemDoNotDecide) {
  const auto pose = solve(kMinConfirmed - 1);
  ASSERT_TRUE(pose);
  EXPECT_GT(error_of(pose->T_reference_camera, truth_).head<3>().norm(), 0.015);
  EXPECT_EQ(pose->voters, 360);
}

TEST_F(ConfirmedFirst, NewOnesThatAgreeTakePart) {
  const std::vector<bool> some = [&] {
    std::vector<bool> confirmed(room_.size(), false);
    std::fill_n(confirmed.begin(), 40, true);
    return confirmed;
  }();
  const auto pose = solve_by_confirmed_first(kinect_sensor(), room_, some, SE3{}, {});
  const auto plain = solve_absolute_pose(kinect_sensor(), room_, SE3{}, {});
  ASSERT_TRUE(pose && plain);
  EXPECT_EQ(pose->T_reference_camera.matrix(), plain->T_reference_camera.matrix());
  EXPECT_EQ(pose->inliers, plain->inliers);
  EXPECT_EQ(pose->voters, 60);
}

TEST_F(ConfirmedFirst, WithoutObservationsThereIsNoPose) {
  EXPECT_FALSE(solve_by_confirmed_first(kinect_sensor(), {}, {}, SE3{}, {}));
}

}  // namespace
}  // namespace kinloop
