#include <gtest/gtest.h>

#include "dense/cloud/point_colors.hpp"
#include "dense/mesh/reconstruct_mesh.hpp"
#include "dense/mesh/simplify_mesh.hpp"
#include "dense/occupancy.hpp"
#include "dense/usable_depth.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/sensor/depth_noise.hpp"
#include "tests/dense/plane_view.hpp"

namespace kinloop {
namespace {

using test::small_camera;

constexpr double kRadiusM = 0.3;
const Eigen::Vector3d kCenter(0, 0, 1.5);

/// Renders the ball in front of a wall (z = 2.2 in the world) from the given pose. The ball is red, the wall
/// blue.
RgbdImages look(const SE3& T_world_camera, bool with_ball, double noise_share, Random& random) {
  const PinholeCamera camera = small_camera();
  RgbdImages images{cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(200, 30, 30)),
                    cv::Mat(camera.height, camera.width, CV_32FC1)};
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector3d ray = T_world_camera.rotation * camera.unproject(Eigen::Vector2d(col, row), 1.0);
      const Eigen::Vector3d eye = T_world_camera.translation;
      double z = (2.2 - eye.z()) / ray.z();
      const double a = ray.squaredNorm(), b = ray.dot(eye - kCenter);
      const double root = b * b - a * ((eye - kCenter).squaredNorm() - kRadiusM * kRadiusM);
      if (with_ball && root > 0) {
        z = (-b - std::sqrt(root)) / a;
        images.color.at<cv::Vec3b>(row, col) = {30, 30, 200};
      }
      z += noise_share * DepthNoise().sigma_m(z) * random.gaussian();
      images.depth_m.at<float>(row, col) = static_cast<float>(z);
    }
  }
  return images;
}

/// Views from left to right.
struct BallScene {
  ImageStore images;
  std::vector<PosedImage> views;
};

BallScene scene_of(const std::vector<bool>& with_ball, double noise_share = 0) {
  BallScene scene;
  Random random(3);
  for (size_t i = 0; i < with_ball.size(); ++i) {
    const double x = 0.4 * (static_cast<double>(i) / static_cast<double>(with_ball.size() - 1) - 0.5);
    const SE3 pose{exp_so3({0, -0.3 * x, 0}), {x, 0, 0}};
    const RgbdImages seen = look(pose, with_ball[i], noise_share, random);
    scene.views.push_back({scene.images.add(seen), pose});
  }
  return scene;
}

MeshOptions some_options() {
  MeshOptions options;
  options.voxel_m = 0.02;
  return options;
}

double off_surface_m(const Eigen::Vector3f& point) {
  const Eigen::Vector3d p = point.cast<double>();
  return std::min(std::abs((p - kCenter).norm() - kRadiusM), std::abs(p.z() - 2.2));
}

bool on_ball(const Eigen::Vector3f& point) {
  return (point.cast<double>() - kCenter).norm() < 1.2 * kRadiusM;
}

#define SKIP_WITHOUT_OPENVDB() \
  if (!tsdf_available()) GTEST_SKIP() << "this build has no OpenVDB"

TEST(Mesh, LiesOnTheSurfaces) {
  SKIP_WITHOUT_OPENVDB();
  for (const double noise_share : {0.0, 1.0}) {
    const BallScene scene = scene_of(std::vector<bool>(9, true), noise_share);
    const auto mesh =
        reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, some_options(), 2);
    ASSERT_GT(mesh.triangles.size(), 3000U);
    std::vector<double> off_m;
    for (const auto& point : mesh.points) off_m.push_back(off_surface_m(point));
    std::sort(off_m.begin(), off_m.end());
    EXPECT_LT(off_m[off_m.size() / 2], 0.002) << noise_share;
    EXPECT_LT(off_m[off_m.size() * 95 / 100], 0.012) << noise_share;
  }
}

TEST(Mesh, DeskewsDelayedDepth) {
  SKIP_WITHOUT_OPENVDB();
  DenseCamera late{.color = small_camera()};
  late.depth_delay_s = 0.04;
  Velocity ahead;
  ahead.linear_m_s.z() = 1;  // m/s: when depth was taken, everything was 4 cm nearer
  const auto median_off_m = [&](const DenseCamera& camera) {
    BallScene scene = scene_of(std::vector<bool>(5, true));
    for (auto& view : scene.views) {
      view.T_world_camera = view.T_world_camera * SE3{Eigen::Quaterniond::Identity(), {0, 0, -0.04}};
      view.velocity = ahead;
    }
    std::vector<double> off_m;
    for (const auto& point : reconstruct_mesh({scene.images, scene.views, camera}, some_options(), 2).points)
      off_m.push_back(off_surface_m(point));
    std::nth_element(off_m.begin(), off_m.begin() + static_cast<long>(off_m.size() / 2), off_m.end());
    return off_m.at(off_m.size() / 2);
  };
  EXPECT_LT(median_off_m(late), 0.003);
  EXPECT_GT(median_off_m({.color = small_camera()}), 0.02);
}

TEST(Mesh, TrianglesFaceTheFreeSide) {
  SKIP_WITHOUT_OPENVDB();
  const BallScene scene = scene_of(std::vector<bool>(5, true));
  const auto mesh =
      reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, some_options(), 2);
  const auto normals = vertex_normals(mesh);
  size_t towards = 0;
  for (size_t i = 0; i < normals.size(); ++i) towards += normals[i].dot(mesh.points[i]) < 0 ? 1 : 0;
  EXPECT_GT(towards, normals.size() * 99 / 100);
}

TEST(Mesh, TakesItsColoursFromTheImages) {
  SKIP_WITHOUT_OPENVDB();
  const BallScene scene = scene_of(std::vector<bool>(5, true));
  const auto mesh =
      reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, some_options(), 2);
  size_t right = 0, judged = 0;
  for (size_t i = 0; i < mesh.points.size(); ++i) {
    if (off_surface_m(mesh.points[i]) > 0.005) continue;
    ++judged;
    right += on_ball(mesh.points[i]) == (mesh.colors[i][0] > mesh.colors[i][2]) ? 1 : 0;
  }
  EXPECT_GT(right, judged * 98 / 100);
}

TEST(Mesh, IsSimplifiedOnRequest) {
  SKIP_WITHOUT_OPENVDB();
  const BallScene scene = scene_of(std::vector<bool>(5, true));
  MeshOptions options = some_options();
  options.triangles = 1000;
  const auto make = [&] {
    return reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, options, 2);
  };
  if (!mesh_simplification_available()) {
    EXPECT_THROW(make(), UsageError);
    return;
  }
  const auto mesh = make();
  EXPECT_LE(mesh.triangles.size(), 1000U);
  EXPECT_GT(mesh.triangles.size(), 900U);
  size_t near = 0, red = 0, ball = 0;
  for (size_t i = 0; i < mesh.points.size(); ++i) {
    near += off_surface_m(mesh.points[i]) < 0.01 ? 1 : 0;
    if (!on_ball(mesh.points[i])) continue;
    ++ball;
    red += mesh.colors[i][0] > mesh.colors[i][2] ? 1 : 0;
  }
  EXPECT_GT(near, mesh.points.size() * 95 / 100);
  EXPECT_GT(red, ball * 90 / 100);
  EXPECT_GT(ball, 50U);
}

TEST(Mesh, RemovesTransientObjects) {
  SKIP_WITHOUT_OPENVDB();
  for (const size_t moment : {0U, 4U, 8U}) {
    std::vector<bool> with_ball(9, false);
    with_ball[moment] = true;
    const BallScene scene = scene_of(with_ball);
    const auto mesh =
        reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, some_options(), 2);
    ASSERT_GT(mesh.points.size(), 1000U);
    EXPECT_EQ(std::count_if(mesh.points.begin(), mesh.points.end(), on_ball), 0) << moment;
  }
}

TEST(Mesh, DoesNotDependOnThreads) {
  SKIP_WITHOUT_OPENVDB();
  const BallScene scene = scene_of(std::vector<bool>(5, true), 1);
  const auto one =
      reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, some_options(), 1);
  const auto four =
      reconstruct_mesh({scene.images, scene.views, {.color = small_camera()}}, some_options(), 4);
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.colors, four.colors);
  EXPECT_EQ(one.triangles, four.triangles);
}

TEST(Mesh, SmallPiecesAreLeftOut) {
  ColoredMesh mesh;
  for (uint32_t piece = 0; piece < 2; ++piece) {
    const auto first = static_cast<uint32_t>(mesh.points.size());
    for (uint32_t i = 0; i <= 2 + piece; ++i) {
      mesh.points.emplace_back(static_cast<float>(i), static_cast<float>(i % 2), static_cast<float>(piece));
      mesh.colors.push_back({static_cast<uint8_t>(piece), 0, 0});
    }
    for (uint32_t i = 0; i <= piece; ++i) mesh.triangles.push_back({first + i, first + i + 1, first + i + 2});
  }
  EXPECT_EQ(remove_small_components(mesh, 1).triangles.size(), 3U);
  const ColoredMesh kept = remove_small_components(mesh, 2);
  EXPECT_EQ(kept.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(kept.colors[0], (Rgb{1, 0, 0}));
}

TEST(PointColors, TheSharpestImageMakesTheColour) {
  ImageStore images;
  cv::Mat depth_m(120, 160, CV_32FC1, cv::Scalar(1.0F));
  cv::Mat blurred(120, 160, CV_8UC3, cv::Scalar(100, 100, 100)), sharp = blurred.clone();
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 160; ++col) {
      if (row / 8 % 2 == col / 8 % 2) sharp.at<cv::Vec3b>(row, col) = {220, 220, 220};
    }
  }
  const std::vector<PosedImage> views = {{images.add({blurred, depth_m}), {}},
                                         {images.add({sharp, depth_m}), {}}};
  const Eigen::Vector3f unseen(0, 0, -1);
  const Eigen::Vector3f point =
      small_camera().unproject({76, 60}, 1.0).cast<float>();  // inside a light square
  const std::vector<Eigen::Vector3f> points = {point, unseen}, normals(2, Eigen::Vector3f(0, 0, -1));
  const auto colors = color_points(points, normals, {images, views, {.color = small_camera()}}, 1);
  EXPECT_GT(colors[0][0], 200);
  EXPECT_EQ(colors[1], (Rgb{128, 128, 128}));
}

TEST(UsableDepth, EdgesAndFarDepthAreNotUsed) {
  cv::Mat depth_m(20, 20, CV_32FC1, cv::Scalar(1.0F));
  depth_m.colRange(10, 20).setTo(2.0F);
  depth_m.at<float>(5, 5) = 9;
  const cv::Mat usable = usable_pixels(depth_m, 500, {0.5, 4, 78});
  EXPECT_EQ(usable.at<uint8_t>(12, 7), 1);
  EXPECT_EQ(usable.at<uint8_t>(12, 9), 0);
  EXPECT_EQ(usable.at<uint8_t>(12, 12), 1);
  EXPECT_EQ(usable.at<uint8_t>(5, 5), 0);
  EXPECT_EQ(usable.at<uint8_t>(0, 5), 0);
}

/// A camera 1 m above a floor, looking ahead and down; a box of 0.4 m stands 1.5 m ahead. Here z is up.
BallScene floor_scene() {
  BallScene scene;
  const PinholeCamera camera = small_camera();
  Eigen::Matrix3d R;  // looks along y, tilted down
  const double tilt = 0.6;
  R.col(0) = Eigen::Vector3d(1, 0, 0);
  R.col(1) = Eigen::Vector3d(0, -std::sin(tilt), -std::cos(tilt));
  R.col(2) = Eigen::Vector3d(0, std::cos(tilt), -std::sin(tilt));
  const SE3 pose{Eigen::Quaterniond(R), {0, 0, 1}};
  cv::Mat depth_m(camera.height, camera.width, CV_32FC1);
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector3d ray = R * camera.unproject(Eigen::Vector2d(col, row), 1.0);
      double z = ray.z() < 0 ? -1 / ray.z() : 0;
      const double front = 1.5 / ray.y();
      const Eigen::Vector3d hit = pose.translation + front * ray;
      if (std::abs(hit.x()) < 0.2 && hit.z() > 0 && hit.z() < 0.4) z = front;
      depth_m.at<float>(row, col) = static_cast<float>(z);
    }
  }
  const cv::Mat color(camera.height, camera.width, CV_8UC3, cv::Scalar(90, 90, 90));
  for (int i = 0; i < 3; ++i) scene.views.push_back({scene.images.add({color, depth_m}), pose});
  return scene;
}

TEST(OccupancyMap, MarksFloorObstacleAndOccludedSpace) {
  if (!occupancy_available()) GTEST_SKIP() << "this build has no OctoMap";
  const BallScene scene = floor_scene();
  OccupancyOptions options;
  options.stride_px = 1;
  options.grid_max_height_m = 0.2;
  const Floor floor =
      find_floor(scene.images, scene.views, small_camera(), Eigen::Vector3d::UnitZ(), options);
  EXPECT_NEAR((floor.T_floor_world * Eigen::Vector3d(0, 0, 0)).z(), 0, 0.02);
  const OccupancyMap map(scene.images, scene.views, small_camera(), floor, options);
  EXPECT_EQ(map.serialize_binary().substr(0, 26), "# Octomap OcTree binary fi");
  EXPECT_EQ(map.serialize_full().substr(0, 20), "# Octomap OcTree fil");
  const OccupancyGrid grid = map.grid();
  const auto at = [&](double x, double y) {
    const int col = static_cast<int>((x - grid.origin_x_m) / grid.cell_m);
    const int row = static_cast<int>((y - grid.origin_y_m) / grid.cell_m);
    return grid.cells.at(static_cast<size_t>(row * grid.width + col));
  };
  EXPECT_EQ(at(0.02, 1.52), Occupancy::kOccupied);
  EXPECT_EQ(at(0.02, 1.1), Occupancy::kFree);
  EXPECT_EQ(at(0.02, 1.7), Occupancy::kUnknown);
}

}  // namespace
}  // namespace kinloop
