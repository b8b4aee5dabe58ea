#include "kinloop/sensor/surfaces/surface_grid.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

RgbdCamera camera_of(int width, int height) {
  RgbdCamera camera;
  camera.color.width = width;
  camera.color.height = height;
  camera.color.fx = camera.color.fy = 0.82 * width;
  camera.color.cx = 0.5 * width - 0.5;
  camera.color.cy = 0.5 * height - 0.5;
  return camera;
}

/// A wall at z = 3 m in the world with a box in front of it, 1.5 m away, as seen from a camera that looks
/// along z from `x_m`.
cv::Mat wall_with_box(const PinholeCamera& camera, double x_m, bool with_box = true) {
  cv::Mat depth_m(camera.height, camera.width, CV_32FC1, cv::Scalar(3.0F));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.unproject(Eigen::Vector2d(x, y), 1.5);
      const bool on_box = std::abs(ray.x() + x_m) < 0.3 && std::abs(ray.y()) < 0.3;
      if (with_box && on_box) depth_m.at<float>(y, x) = 1.5F;
    }
  }
  return depth_m;
}

SE3 moved_by(double x_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, 0, 0}};
}

class Surfaces : public testing::TestWithParam<cv::Size> {
 protected:
  [[nodiscard]] SurfaceGrid view(double x_m, bool with_box = true) const {
    return make_surface_grid(surface_camera_, wall_with_box(camera_.color, x_m, with_box));
  }

  RgbdCamera camera_ = camera_of(GetParam().width, GetParam().height);
  std::shared_ptr<const SurfaceCamera> surface_camera_ = make_surface_camera(make_sensor(camera_));
};

TEST_P(Surfaces, TheTruePoseIsNotContradicted) {
  const auto agreement = compare_surfaces(view(0), view(0.2), moved_by(0.2));
  EXPECT_GT(agreement.consistent, 1500);
  EXPECT_EQ(agreement.contradicted, 0);
  EXPECT_GT(agreement.occluded, 0);  // the box hides other parts of the wall
}

TEST_P(Surfaces, AWrongPoseIsContradicted) {
  const auto agreement = compare_surfaces(view(0), view(0.2), moved_by(0));
  EXPECT_GT(agreement.contradicted_share(), 0.03);
}

TEST_P(Surfaces, AWrongDistanceContradictsAllOfAWall) {
  const SE3 T_a_b(Eigen::Quaterniond::Identity(), {0, 0, -0.5});
  EXPECT_GT(compare_surfaces(view(0, false), view(0, false), T_a_b).contradicted_share(), 0.4);
}

TEST_P(Surfaces, SomethingNewIsContradictedByTheViewThatSawThrough) {
  const auto states = states_in_view(view(0), view(0, false), SE3{});
  const int middle =
      surface_camera_->grid.height / 2 * surface_camera_->grid.width + surface_camera_->grid.width / 2;
  EXPECT_EQ(states[static_cast<size_t>(middle)], PointState::kContradicted);
  EXPECT_EQ(states[static_cast<size_t>(5 * surface_camera_->grid.width + 5)], PointState::kConsistent);
  const auto reversed = states_in_view(view(0, false), view(0), SE3{});
  EXPECT_EQ(reversed[static_cast<size_t>(middle)], PointState::kOccluded);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Surfaces,
                         testing::Values(cv::Size(640, 480), cv::Size(320, 240), cv::Size(1280, 720)));

TEST(SurfaceGrid, WithoutDepthSaysNothing) {
  const RgbdCamera camera = camera_of(320, 240);
  const auto surface_camera = make_surface_camera(make_sensor(camera));
  cv::Mat depth_m(240, 320, CV_32FC1, cv::Scalar(0.0F));
  depth_m.row(100).setTo(std::numeric_limits<float>::quiet_NaN());
  const SurfaceGrid nothing = make_surface_grid(surface_camera, depth_m);
  const SurfaceGrid wall = make_surface_grid(surface_camera, wall_with_box(camera.color, 0));
  const auto agreement = compare_surfaces(nothing, wall, SE3{});
  EXPECT_EQ(agreement.consistent + agreement.contradicted + agreement.occluded, 0);
  EXPECT_EQ(agreement.contradicted_share(), 0);
}

TEST(SurfaceGrid, TheSmallestCamerasHaveOne) {
  for (const cv::Size size : {cv::Size(8, 6), cv::Size(1, 1), cv::Size(65, 2)}) {
    const RgbdCamera camera = camera_of(size.width, size.height);
    const auto surface_camera = make_surface_camera(make_sensor(camera));
    const cv::Mat depth_m(size, CV_32FC1, cv::Scalar(1.0F));
    const SurfaceGrid grid = make_surface_grid(surface_camera, depth_m);
    EXPECT_EQ(grid.gradients.size(), surface_camera->pixels.size());
    EXPECT_EQ(compare_surfaces(grid, grid, SE3{}).contradicted, 0);
  }
}

TEST(SurfaceGrid, SeesThroughTheLens) {
  RgbdCamera camera = camera_of(640, 480);
  camera.color.lens.k1 = 0.2;
  const auto surface_camera = make_surface_camera(make_sensor(camera));
  // A plane that is slanted in the ideal image: inverse depth grows with x.
  cv::Mat depth_m(480, 640, CV_32FC1);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const Eigen::Vector2d ideal = camera.color.undistort(Eigen::Vector2d(x, y));
      depth_m.at<float>(y, x) = static_cast<float>(1 / (0.2 + 0.0005 * (ideal.x() + 100)));
    }
  }
  const SurfaceGrid grid = make_surface_grid(surface_camera, depth_m);
  size_t known = 0;
  for (size_t i = 0; i < grid.gradients.size(); ++i) {
    if (!grid.gradients[i].allFinite()) continue;
    ++known;
    EXPECT_NEAR(grid.gradients[i].x(), 0.005, 0.001);
    EXPECT_NEAR(grid.gradients[i].y(), 0, 0.001);
  }
  EXPECT_GT(known, grid.gradients.size() / 2);
}

TEST(SurfaceGrid, RejectsOtherTypesOfDepth) {
  const auto surface_camera = make_surface_camera(make_sensor(camera_of(320, 240)));
  EXPECT_THROW(make_surface_grid(surface_camera, cv::Mat(240, 320, CV_16UC1, cv::Scalar(1))),
               std::logic_error);
}

}  // namespace
}  // namespace kinloop
