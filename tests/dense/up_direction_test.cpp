#include "dense/up_direction.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using Eigen::Vector3d;
using Normals = std::vector<Eigen::Vector3f>;

constexpr double kDegree = std::numbers::pi / 180;

/// A camera in a world with z up, turned by `yaw`, looking down by `pitch`, rolled by `roll`; radians.
SE3 held(double yaw, double pitch, double roll) {
  Eigen::Matrix3d level;  // looks along world y
  level << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const SE3 T_world_level{Eigen::Quaterniond(level), Vector3d::Zero()};
  const SE3 turn{exp_so3({0, 0, yaw}), Vector3d::Zero()};
  const SE3 tilt{exp_so3({-pitch, 0, 0}), Vector3d::Zero()};
  const SE3 skew{exp_so3({0, 0, roll}), Vector3d::Zero()};
  return turn * T_world_level * tilt * skew;
}

void add(Normals& normals, const Vector3d& normal, int count, Random& random) {
  constexpr double kNoise = 0.05;
  for (int i = 0; i < count; ++i) {
    const Vector3d noise = test::gaussian_vector<3>(random);
    normals.push_back((normal + kNoise * noise).normalized().cast<float>());
  }
}

void add_clutter(Normals& normals, int count, Random& random) {
  for (int i = 0; i < count; ++i) {
    normals.push_back(test::gaussian_vector<3>(random).normalized().cast<float>());
  }
}

/// A room seen all around: a floor with tables, some ceiling, walls, furniture aligned with the walls or not,
/// clutter.
Normals room(uint64_t seed) {
  Random random(seed);
  Normals normals;
  add(normals, {0, 0, 1}, 1500, random);
  add(normals, {0, 0, -1}, 400, random);
  for (const double x : {-1.0, 1.0})
    add(normals, {x, 0, 0}, 800, random), add(normals, {0, x, 0}, 600, random);
  for (int i = 0; i < 10; ++i) {
    const double yaw = random.uniform(0, 2 * std::numbers::pi);
    add(normals, {std::cos(yaw), std::sin(yaw), 0}, 60, random);
  }
  add_clutter(normals, 1500, random);
  return normals;
}

/// One full turn, looking slightly down, rolled by `roll` as a function of progress.
template <class Roll>
std::vector<SE3> once_around(const Roll& roll) {
  std::vector<SE3> cameras;
  for (int i = 0; i < 60; ++i) {
    const double s = i / 60.0;
    cameras.push_back(held(2 * std::numbers::pi * s, 0.2 + 0.1 * std::sin(40 * s), roll(s)));
  }
  return cameras;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

TEST(UpDirection, OfARoomIsTheFloorsNormalHoweverTheCameraIsRolled) {
  const Normals normals = room(1);
  for (int roll_deg = -180; roll_deg < 180; roll_deg += 30) {
    const auto up = estimate_up_direction(normals, once_around([&](double) { return roll_deg * kDegree; }));
    EXPECT_EQ(up.source, UpSource::kPlanes) << roll_deg;
    EXPECT_LT(angle_deg(up.direction, Vector3d::UnitZ()), 1) << roll_deg;
  }
  for (const double turns : {0.5, 1.0, 2.5}) {
    const auto up = estimate_up_direction(
        normals, once_around([&](double s) { return 2 * std::numbers::pi * turns * s; }));
    EXPECT_EQ(up.source, UpSource::kPlanes) << turns;
    EXPECT_LT(angle_deg(up.direction, Vector3d::UnitZ()), 1) << turns;
  }
}

TEST(UpDirection, TurnsWithTheWorld) {
  Random random(5);
  for (int i = 0; i < 10; ++i) {
    const SE3 turn{exp_so3(3 * test::gaussian_vector<3>(random)), Vector3d(1, 2, 3)};
    Normals normals = room(2);
    for (auto& normal : normals) normal = (turn.rotation * normal.cast<double>()).cast<float>();
    auto cameras = once_around([&](double s) { return 0.3 * std::sin(9 * s); });
    for (SE3& camera : cameras) camera = turn * camera;
    const auto up = estimate_up_direction(normals, cameras);
    EXPECT_EQ(up.source, UpSource::kPlanes);
    EXPECT_GT(up.confidence, 0.9);
    EXPECT_LT(angle_deg(up.direction, turn.rotation * Vector3d::UnitZ()), 1);
  }
}

TEST(UpDirection, OfADeskBeforeAWallIsNotTheMeanOfTheCameras) {
  Random random(3);
  Normals normals;
  add(normals, {0, 0, 1}, 1500, random);
  add(normals, {0, -1, 0}, 800, random);
  add(normals, {1, 0, 0}, 150, random);
  add(normals, {-1, 0, 0}, 150, random);
  add_clutter(normals, 500, random);
  const std::vector<SE3> cameras{held(-0.2, 0.6, 0.1), held(0, 0.5, 0), held(0.2, 0.6, -0.1)};
  const auto up = estimate_up_direction(normals, cameras);
  EXPECT_EQ(up.source, UpSource::kPlanes);
  EXPECT_LT(angle_deg(up.direction, Vector3d::UnitZ()), 1);
  EXPECT_GT(angle_deg(mean_camera_up(cameras).direction, Vector3d::UnitZ()), 25);
}

TEST(UpDirection, OfWallsAloneIsWhatTheyHaveInCommon) {
  Random random(4);
  Normals normals;
  for (const double x : {-1.0, 1.0})
    add(normals, {x, 0, 0}, 800, random), add(normals, {0, x, 0}, 600, random);
  const auto up = estimate_up_direction(normals, once_around([](double) { return 0.1; }));
  EXPECT_EQ(up.source, UpSource::kPlanes);
  EXPECT_LT(angle_deg(up.direction, Vector3d::UnitZ()), 1);
}

TEST(UpDirection, WithoutPlanesIsTheMeanOfTheCameras) {
  Random random(6);
  const std::vector<SE3> cameras{held(0, 0.3, 0.2), held(0.1, 0.3, 0.1)};
  const Vector3d mean = mean_camera_up(cameras).direction;
  Normals nothing_level, one_wall, few;
  add_clutter(nothing_level, 5000, random);
  add(one_wall, {0, -1, 0}, 5000, random);
  add(few, {0, 0, 1}, 100, random), add(few, {0, -1, 0}, 100, random);
  for (const Normals& normals : {nothing_level, one_wall, few, Normals()}) {
    const auto up = estimate_up_direction(normals, cameras);
    EXPECT_EQ(up.source, UpSource::kCamera);
    EXPECT_EQ(up.direction, mean);
  }
}

TEST(UpDirection, CamerasThatSurfacesContradictAreNotTrusted) {
  Random random(7);
  Normals normals;  // a corner of three sides alike: each may be the floor
  for (const Vector3d& side : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, -1, 0)})
    add(normals, side, 1000, random);
  const std::vector<SE3> turned(10, held(0, 0, 45 * kDegree));
  const auto up = estimate_up_direction(normals, turned);
  EXPECT_EQ(up.source, UpSource::kCamera);
  EXPECT_LT(up.confidence, 0.6);
}

TEST(UpDirection, OfACameraThatDoesNotMoveIsItsOwn) {
  const std::vector<SE3> cameras(10, held(0, 0.3, 0));
  const auto up = estimate_up_direction({}, cameras);
  EXPECT_LT((up.direction + cameras.front().R().col(1)).norm(), 1e-6);
  EXPECT_NEAR(up.confidence, 1, 1e-9);
}

TEST(UpDirection, OfNothingIsTheFirstCamerasUp) {
  const auto up = estimate_up_direction({}, {});
  EXPECT_EQ(up.direction, -Vector3d::UnitY());
  EXPECT_EQ(up.source, UpSource::kCamera);
  EXPECT_EQ(up.confidence, 0);
}

TEST(UprightRotation, PutsUpAlongZAndTheFirstViewAlongY) {
  const SE3 first = held(0.7, 0.4, 1.2);
  const Eigen::Matrix3d R = upright_rotation(Vector3d::UnitZ(), first).toRotationMatrix();
  EXPECT_NEAR(R.determinant(), 1, 1e-12);
  EXPECT_LT((R * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 1e-12);
  const Vector3d view = R * first.R().col(2);
  EXPECT_NEAR(view.x(), 0, 1e-12);
  EXPECT_GT(view.y(), 0);
  // Straight down: the top of the image points ahead.
  const SE3 down = held(0.7, std::numbers::pi / 2, 0);
  const Vector3d top = upright_rotation(Vector3d::UnitZ(), down) * Vector3d(-down.R().col(1));
  EXPECT_LT((top - Vector3d::UnitY()).norm(), 1e-9);
}

}  // namespace
}  // namespace kinloop
