// Scenes in which places look alike: a corridor that repeats itself, and the floors of a building.

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/errors.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/room/room_layout.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {
namespace {

SimulationOptions ideal() {
  SimulationOptions options;
  options.remove_noise();
  options.width = 160;
  options.height = 120;
  return options;
}

SimulationOptions corridor() {
  SimulationOptions options = ideal();
  options.corridor = true;
  return options;
}

SimulationOptions on_floor(int floor) {
  SimulationOptions options = ideal();
  options.floor = floor;
  return options;
}

TEST(Corridor, RepeatsItself) {
  const SimulatedSource source("corridor", 1, corridor(), 2);
  const Eigen::Vector3d period(sim::kCorridorPeriod_m, 0, 0);
  double nearest_m = 10;
  for (double x = -3.5; x < 0; x += 0.23) {
    for (const double y : {-0.9, 0.85}) {
      const Eigen::Vector3d p(x, y, 1.4);
      const double distance_m = source.distance_to_surface(p);
      nearest_m = std::min(nearest_m, distance_m);
      EXPECT_NEAR(source.distance_to_surface(p + period), distance_m, 1e-4) << x << " " << y;
    }
  }
  EXPECT_LT(nearest_m, 0.1) << "the points are near the walls";
}

TEST(Corridor, IsWalkedThereAndBack) {
  const Trajectory path = sim::corridor_path(1);
  double farthest_m = 0;
  for (const StampedPose& pose : path)
    farthest_m =
        std::max(farthest_m, (pose.T_world_camera.translation - path[0].T_world_camera.translation).norm());
  EXPECT_GT(farthest_m, 13.5);
  const SE3 &first = path.front().T_world_camera, &last = path.back().T_world_camera;
  EXPECT_LT((last.translation - first.translation).norm(), 0.5);
  EXPECT_LT(first.R().col(2).dot(last.R().col(2)), 0) << "looks the other way on its way back";
}

TEST(Corridor, NothingMovesInIt) {
  SimulationOptions options = corridor();
  options.movers.people = 1;
  EXPECT_THROW(SimulatedSource("corridor", 1, options, 2), UsageError);
}

TEST(Floors, HaveTheSameFurnitureAndOtherPictures) {
  const SimulatedSource first("floor", 1, on_floor(1), 2), second("floor", 1, on_floor(2), 2);
  int pixels = 0, same_depth = 0;
  double color_change = 0;
  for (const size_t index : {0U, 200U, 400U}) {
    const Frame a = first.frame(index), b = second.frame(index);
    pixels += static_cast<int>(a.depth_m.total());
    same_depth += cv::countNonZero(cv::abs(a.depth_m - b.depth_m) < 0.03);
    color_change +=
        cv::norm(a.color.bgr(), b.color.bgr(), cv::NORM_L1) / static_cast<double>(a.depth_m.total());
  }
  EXPECT_GT(same_depth, pixels * 7 / 10);
  EXPECT_LT(same_depth, pixels);
  EXPECT_GT(color_change / 3, 10);
}

}  // namespace
}  // namespace kinloop
