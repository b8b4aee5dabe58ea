#include "kinloop/tracking/evidence/moved_points.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/sensor/vga_surfaces.hpp"

namespace kinloop {
namespace {

/// A wall 3 m away, in front of which a box 1 m away stands or not.
class MovedPoints : public testing::Test {
 protected:
  [[nodiscard]] SurfaceGrid wall(const cv::Rect& box = {}, const cv::Rect& unknown = {}) const {
    cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(3.0F));
    depth_m(box) = 1.0F;
    depth_m(unknown) = 0.0F;
    return make_surface_grid(camera_, depth_m);
  }

  static cv::Mat moved(const SurfaceGrid& frame, const std::vector<const SurfaceGrid*>& views) {
    std::vector<SurfaceView> all;
    for (const SurfaceGrid* view : views) all.push_back({view, SE3{}});
    return moved_points(frame, all);
  }

  /// Share of the points on `box` that have moved.
  static double share_of(const cv::Mat& moved, const cv::Rect& box) {
    if (moved.empty()) return 0;
    const cv::Rect points(box.x / 10, box.y / 10, box.width / 10, box.height / 10);
    return static_cast<double>(cv::countNonZero(moved(points))) / points.area();
  }

  std::shared_ptr<const SurfaceCamera> camera_ = test::vga_surface_camera();
};

const cv::Rect kBox(200, 100, 200, 250);

TEST_F(MovedPoints, ABoxThatWasNotThereHasMoved) {
  const SurfaceGrid empty = wall(), with_box = wall(kBox);
  const cv::Mat points = moved(with_box, {&empty, &empty});
  EXPECT_EQ(share_of(points, kBox), 1);
  EXPECT_LT(cv::countNonZero(points), kBox.area() / 100 * 1.3);
}

TEST_F(MovedPoints, NothingHasMovedInAStaticScene) {
  const SurfaceGrid with_box = wall(kBox);
  EXPECT_TRUE(moved(with_box, {&with_box, &with_box, &with_box}).empty());
}

TEST_F(MovedPoints, WhatComesIntoViewBehindABoxThatLeftHasNotMoved) {
  const SurfaceGrid empty = wall(), with_box = wall(kBox);
  EXPECT_TRUE(moved(empty, {&with_box, &with_box}).empty());
}

TEST_F(MovedPoints, OneViewOfManyDoesNotDecide) {
  const SurfaceGrid empty = wall(), with_box = wall(kBox), unknown = wall({}, {0, 0, 640, 480});
  EXPECT_TRUE(moved(with_box, {&empty, &with_box}).empty());
  EXPECT_TRUE(moved(with_box, {&empty, &unknown}).empty());
  EXPECT_EQ(share_of(moved(with_box, {&empty}), kBox), 1);  // the only one does
}

TEST_F(MovedPoints, ABoxThatStaysIsAcceptedOnceViewsShowIt) {
  const SurfaceGrid empty = wall(), with_box = wall(kBox);
  EXPECT_TRUE(moved(with_box, {&empty, &empty, &with_box}).empty());
}

TEST_F(MovedPoints, ItsSurfaceGoesOnWhereNoViewKnowsAnything) {
  const SurfaceGrid half_known = wall({}, {300, 0, 340, 480}), with_box = wall(kBox);
  const cv::Mat points = moved(with_box, {&half_known, &half_known});
  EXPECT_EQ(share_of(points, kBox), 1);
  EXPECT_LT(cv::countNonZero(points), kBox.area() / 100 * 1.3);  // and not over the wall beside it
}

TEST_F(MovedPoints, ABoxThatMovesAlongItsFrontHasMovedWhereItOverlapsItself) {
  const SurfaceGrid before = wall({150, 100, 200, 250}), now = wall(kBox);
  EXPECT_EQ(share_of(moved(now, {&before, &before}), kBox), 1);
}

TEST_F(MovedPoints, AViewWithoutTheBoxDoesNotSpeakForItsSurface) {
  const SurfaceGrid before = wall({150, 100, 200, 250}), now = wall(kBox);
  EXPECT_TRUE(moved(now, {&before, &now}).empty());  // the other finds it at rest
}

TEST_F(MovedPoints, AWallDoesNotLeaveBecauseAPartOfItIsFarther) {
  cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(1.0F));
  const SurfaceGrid before = make_surface_grid(camera_, depth_m);
  depth_m(cv::Rect(0, 0, 100, 200)) = 2.0F;
  const SurfaceGrid now = make_surface_grid(camera_, depth_m);
  EXPECT_TRUE(moved(now, {&before, &before}).empty());
}

TEST_F(MovedPoints, SmallRegionsAreNoise) {
  const SurfaceGrid empty = wall(), with_box = wall({200, 100, 60, 50});
  EXPECT_TRUE(moved(with_box, {&empty, &empty}).empty());
}

TEST_F(MovedPoints, WithoutSurfacesNothingIsKnown) {
  EXPECT_TRUE(moved_points(LocalMap{}, Frame{}, SE3{}).empty());
}

}  // namespace
}  // namespace kinloop
