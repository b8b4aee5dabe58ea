#include <utility>

#include <gtest/gtest.h>

#include "kinloop/back_end/final/final_pass.hpp"
#include "tests/sensor/vga_surfaces.hpp"

namespace kinloop {
namespace {

const cv::Rect kBox(200, 100, 200, 250);
constexpr uint32_t kOnBox = 0, kOnWall = 1;  // keypoints

/// A camera at rest before a wall 3 m away. A box stands 1 m away in its first keyframes, and has gone in the
/// others.
class WithdrawMoved : public testing::Test {
 protected:
  WithdrawMoved() {
    auto features = std::make_shared<Features>();
    features->pixels = {{300, 225}, {600, 400}};
    features->depths_m = {1, 3};
    features_ = features;
  }

  void add_keyframes(int count, bool with_box, const SE3& T_world_camera = {}, float wall_m = 3) {
    cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(wall_m));
    if (with_box) depth_m(kBox) = 1.0F;
    const auto surfaces = std::make_shared<const SurfaceGrid>(make_surface_grid(camera_, depth_m));
    for (int i = 0; i < count; ++i) {
      const auto number = static_cast<uint32_t>(map_.keyframes().size());
      const KeyframeId id = map_.add_keyframe(FrameId{number}, number, T_world_camera, features_, 0);
      map_.set_surfaces(id, surfaces);
    }
  }

  /// The landmark at a keypoint of the first keyframe, seen there.
  LandmarkId add_landmark(uint32_t keypoint) {
    const Eigen::Vector3d p_camera = camera_->grid.unproject(
        features_->pixels[keypoint].cast<double>() / 10, static_cast<double>(features_->depths_m[keypoint]));
    return map_.add_landmark(KeyframeId{0}, keypoint, p_camera);
  }

  std::shared_ptr<const SurfaceCamera> camera_ = test::vga_surface_camera();
  std::shared_ptr<const Features> features_;
  Map map_;
};

TEST_F(WithdrawMoved, TakesLandmarksThroughWhichOthersSaw) {
  add_keyframes(1, true), add_keyframes(3, false);
  const LandmarkId on_box = add_landmark(kOnBox), on_wall = add_landmark(kOnWall);
  EXPECT_EQ(erase_moved_landmarks(map_), 1U);
  EXPECT_FALSE(map_.contains(on_box));
  EXPECT_TRUE(map_.contains(on_wall));
}

TEST_F(WithdrawMoved, OneViewDoesNotDecide) {
  add_keyframes(1, true), add_keyframes(1, false);
  add_landmark(kOnBox);
  EXPECT_EQ(erase_moved_landmarks(map_), 0U);
}

TEST_F(WithdrawMoved, WhatMoreViewsFindThereStays) {
  add_keyframes(5, true), add_keyframes(3, false);
  add_landmark(kOnBox);
  EXPECT_EQ(erase_moved_landmarks(map_), 0U);
  add_keyframes(2, false);
  EXPECT_EQ(erase_moved_landmarks(map_), 1U);
}

TEST_F(WithdrawMoved, ThoseThatObserveALandmarkHaveNoSay) {
  add_keyframes(5, true), add_keyframes(3, false);
  const LandmarkId on_box = add_landmark(kOnBox);
  for (uint32_t i = 1; i < 5; ++i) map_.add_observation(on_box, {KeyframeId{i}, kOnBox});
  EXPECT_EQ(erase_moved_landmarks(map_), 1U);
}

TEST_F(WithdrawMoved, ViewsOfOtherPlacesHaveNoSay) {
  add_keyframes(1, true), add_keyframes(3, false, {{1, 0, 0, 0}, {0, 0, -2.5}}, 5.5F);
  add_landmark(kOnBox);
  EXPECT_EQ(erase_moved_landmarks(map_), 0U);
  add_keyframes(3, false, {{1, 0, 0, 0}, {0, 0, -1.5}}, 4.5F);
  EXPECT_EQ(erase_moved_landmarks(map_), 1U) << "from 1.5 m behind";
}

TEST_F(WithdrawMoved, ThinThingsStay) {
  add_keyframes(4, false);  // not even the grid of the keyframe that measured it shows the cable
  add_landmark(kOnBox);
  EXPECT_EQ(erase_moved_landmarks(map_), 0U);
}

TEST_F(WithdrawMoved, LandmarksWithoutMeasuredDepthStay) {
  auto features = std::make_shared<Features>(*features_);
  features->depths_m[kOnBox] = 0;
  const auto measured = std::exchange(features_, features);
  add_keyframes(1, true), add_keyframes(3, false);
  features_ = measured;
  add_landmark(kOnBox);
  EXPECT_EQ(erase_moved_landmarks(map_), 0U);
}

TEST_F(WithdrawMoved, IsPossibleWithoutSurfaces) {
  for (uint32_t i = 0; i < 4; ++i) map_.add_keyframe(FrameId{i}, i, SE3{}, features_, 0);
  add_landmark(kOnBox);
  EXPECT_EQ(erase_moved_landmarks(map_), 0U);
}

}  // namespace
}  // namespace kinloop
