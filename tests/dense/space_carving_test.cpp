#include "dense/cloud/space_carving.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/sensor/depth_noise.hpp"
#include "tests/dense/plane_view.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

constexpr double kVoxel_m = 0.01;

DenseCamera moving_camera() {
  DenseCamera camera{.color = test::distorted_camera()};
  camera.depth_delay_s = 0.02;
  camera.readout_s = 0.03;
  return camera;
}

/// Points all around the cameras, some in and some behind their views.
std::vector<SurfacePoint> random_points(Random& random, size_t count) {
  std::vector<SurfacePoint> points(count);
  for (SurfacePoint& point : points) {
    const Eigen::Vector3d p = test::uniform_vector<3>(random, {-2, -2, -1}, {2, 2, 4});
    point.p_world = p.cast<float>();
    point.key = voxel_key(Eigen::Vector3d((p / kVoxel_m).array().floor()));
    point.views = static_cast<int>(1 + random.index(3));
  }
  std::sort(points.begin(), points.end(),
            [](const SurfacePoint& a, const SurfacePoint& b) { return block_of(a.key) < block_of(b.key); });
  return points;
}

MeasuredFreeSpace random_view(Random& random, const PinholeCamera& camera) {
  MeasuredFreeSpace view;
  const Eigen::Vector3d turn = test::gaussian_vector<3>(random);
  view.T_camera_world = {exp_so3(0.3 * turn), {0.2 * random.gaussian(), 0.2 * random.gaussian(), 0}};
  view.velocity = {{0.3, -0.2, 0.4}, {0.5, -0.6, 0.2}};
  view.depth_stamp_difference_s = 0.1 * (random.uniform() - 0.5);
  for (int i = 0; i < (camera.width / kTilePx) * (camera.height / kTilePx); ++i) {
    const double z = 0.8 + 2 * random.uniform();
    view.nearest.push_back(random.uniform() < 0.1 ? uint16_t{0}
                                                  : static_cast<uint16_t>(1 / z / kTileStep_per_m));
  }
  return view;
}

/// The largest inverse depth of the tiles of all pixels within 2 px; 0 if any is unknown.
double nearest_around(const Eigen::Vector2d& pixel, const MeasuredFreeSpace& view,
                      const PinholeCamera& camera) {
  const int cols = camera.width / kTilePx;
  uint16_t most = 0;
  for (const int down : {-2, 2}) {
    for (const int right : {-2, 2}) {
      const int row = (static_cast<int>(pixel.y()) + down) / kTilePx;
      const int col = (static_cast<int>(pixel.x()) + right) / kTilePx;
      const uint16_t here = view.nearest[static_cast<size_t>(row * cols + col)];
      if (here == 0) return 0;
      most = std::max(most, here);
    }
  }
  return most * kTileStep_per_m;
}

/// One view of one point as the documentation tells it.
int contradiction(const SurfacePoint& point, const MeasuredFreeSpace& view, const DenseCamera& camera,
                  const DenseOptions& options) {
  const Eigen::Vector3d p_stamp = view.T_camera_world * point.p_world.cast<double>();
  if (!(p_stamp.z() > 0)) return 0;
  const Eigen::Vector3d p = camera.undo_deskew(p_stamp, view.velocity, view.depth_stamp_difference_s);
  if (!(p.z() > 0) || !camera.color.contains(camera.color.project(p))) return 0;
  const Eigen::Vector2d pixel = camera.color.distort(camera.color.project(p));
  if (!camera.color.contains(pixel, 2)) return 0;
  const double nearest = nearest_around(pixel, view, camera.color), here = 1 / p.z();
  const double margin = 4 * DepthNoise().coefficient_per_m + 2 * options.voxel_m * here * here;
  const bool in_sight = nearest == 0 || nearest - here <= margin;
  const bool free = nearest > 0 && here - nearest > margin;
  return point.views < options.min_observations ? in_sight : free && options.carve;
}

TEST(SpaceCarving, CountsAsEveryPointInEveryView) {
  Random random(4);
  const DenseCamera camera = moving_camera();
  for (const bool carve : {true, false}) {
    DenseOptions options;
    options.voxel_m = kVoxel_m;
    options.carve = carve;
    auto points = random_points(random, 20'000);
    std::vector<MeasuredFreeSpace> views;
    for (int i = 0; i < 8; ++i) views.push_back(random_view(random, camera.color));
    std::vector<int> expected;
    for (const SurfacePoint& point : points) {
      int& count = expected.emplace_back(0);
      for (const MeasuredFreeSpace& view : views) count += contradiction(point, view, camera, options);
    }
    ASSERT_GT(std::count_if(expected.begin(), expected.end(), [](int n) { return n > 0; }), 1000);
    auto again = points;
    count_contradictions(points, views, camera, options, 1);
    count_contradictions(again, views, camera, options, 3);
    for (size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(points[i].contradictions, expected[i]) << i;
      ASSERT_EQ(again[i].contradictions, expected[i]) << i;
    }
  }
}

TEST(SpaceCarving, ManyPointsOfOneBlockAreAllJudged) {
  const DenseCamera camera{.color = test::small_camera()};
  MeasuredFreeSpace view;
  view.nearest.assign(40 * 30, static_cast<uint16_t>(1 / 3.0 / kTileStep_per_m));
  SurfacePoint point;
  point.p_world = {0.05F, 0.05F, 1.5F};
  point.key = voxel_key(5, 5, 150);
  point.views = 2;
  std::vector<SurfacePoint> points(1000, point);
  count_contradictions(points, std::vector{view}, camera, {}, 1);
  for (const SurfacePoint& judged : points) EXPECT_EQ(judged.contradictions, 1);
}

}  // namespace
}  // namespace kinloop
