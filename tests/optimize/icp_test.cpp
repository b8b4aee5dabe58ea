#include "kinloop/optimize/pose/icp.hpp"

#include <functional>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/optimize/synthetic_view.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kNan;

PinholeCamera small_camera(bool distorted) {
  PinholeCamera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 262;
  camera.cx = 159.5;
  camera.cy = 119.5;
  if (distorted) {
    camera.lens.k1 = 0.26;
    camera.lens.k2 = -0.95;
    camera.lens.k3 = 1.16;
    camera.lens.p1 = -0.005;
  }
  return camera;
}

/// Distance along a ray to the nearest surface, infinity if none.
using Scene = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;

double hit_plane(const Eigen::Vector3d& o, const Eigen::Vector3d& d, int axis, double at) {
  const double distance = (at - o(axis)) / d(axis);
  return distance > 0 ? distance : std::numeric_limits<double>::infinity();
}

double hit_sphere(const Eigen::Vector3d& o, const Eigen::Vector3d& d, const Eigen::Vector3d& centre,
                  double r) {
  const double a = d.squaredNorm(), b = d.dot(o - centre), c = (o - centre).squaredNorm() - r * r;
  const double root = b * b - a * c;
  if (root < 0) return std::numeric_limits<double>::infinity();
  const double distance = (-b - std::sqrt(root)) / a;
  return distance > 0 ? distance : std::numeric_limits<double>::infinity();
}

double corner_scene(const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  return std::min({hit_plane(o, d, 2, 3.0), hit_plane(o, d, 0, 1.1), hit_plane(o, d, 1, 0.9),
                   hit_sphere(o, d, {-0.5, 0.2, 2.2}, 0.5), hit_sphere(o, d, {0.5, -0.4, 2.5}, 0.3)});
}

double wall_scene(const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  return hit_plane(o, d, 2, 2.0);
}

struct View {
  cv::Mat depth_m, gray;
};

View render(const Scene& scene, const PinholeCamera& camera, const SE3& T_world_camera, double noise,
            Random& random) {
  View view{cv::Mat(camera.height, camera.width, CV_32FC1), cv::Mat(camera.height, camera.width, CV_8UC1)};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.unproject(camera.undistort(Eigen::Vector2d(x, y)), 1.0);
      const Eigen::Vector3d direction = T_world_camera.rotation * ray;
      const double z = scene(T_world_camera.translation, direction);
      const double inverse = 1 / z + noise * random.gaussian();
      view.depth_m.at<float>(y, x) = std::isfinite(z) ? static_cast<float>(1 / inverse) : 0.0F;
      const Eigen::Vector3d p = T_world_camera.translation + z * direction;
      const double value =
          128 + 50 * std::sin(9 * p.x() + 3 * p.y()) + 50 * std::sin(8 * p.y() - 4 * p.x() + p.z());
      view.gray.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(value);
    }
  }
  return view;
}

struct Alignment {
  SE3 truth;
  std::optional<IcpSolution> solution;
};

Alignment align(const Scene& scene, const PinholeCamera& camera, const SE3& truth, double noise,
                const IcpOptions& options, uint64_t seed = 1) {
  Random random(seed);
  const IcpCamera icp = make_icp_camera(Sensor{camera}, options);
  const View a = render(scene, camera, {}, noise, random);
  const View b = render(scene, camera, truth, noise, random);
  return {truth, align_icp(icp, make_icp_frame(icp, a.depth_m, a.gray),
                           make_icp_frame(icp, b.depth_m, b.gray), {}, options)};
}

SE3 small_motion() {
  return {exp_so3({0.02, -0.03, 0.015}), {0.03, -0.02, 0.04}};
}

IcpOptions by_depth_alone() {
  IcpOptions options;
  options.photometric_weight = 0;
  return options;
}

TEST(Icp, FindsTheMotionInACorner) {
  const auto [truth, solution] =
      align(corner_scene, small_camera(false), small_motion(), 0, by_depth_alone());
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1.5e-3);
  EXPECT_GT(solution->overlap, 0.6);
  EXPECT_LT(solution->rmse_m, 0.004);
}

TEST(Icp, LensDistortionIsCorrected) {
  const auto [truth, solution] = align(corner_scene, small_camera(true), small_motion(), 0, by_depth_alone());
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1.5e-3);
}

TEST(Icp, ErrorStaysWithinTheStatedInformation) {
  for (const IcpOptions& options : {IcpOptions{}, by_depth_alone()}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const auto [truth, solution] = align(corner_scene, small_camera(true), small_motion(),
                                           NoiseModel().surface.coefficient_per_m, options, seed);
      ASSERT_TRUE(solution.has_value());
      const Vector6d error = error_of(solution->T_reference_camera, truth);
      EXPECT_LT(error.norm(), 5e-3);
      EXPECT_LT(error.dot(solution->information * error), 22.5) << "99.9 % of chi2 with 6 degrees";
    }
  }
}

TEST(Icp, AWallLeavesThreeDirectionsUnconstrained) {
  const SE3 truth{exp_so3({0.02, -0.02, 0}), {0, 0, 0.05}};
  const auto [unused, solution] = align(wall_scene, small_camera(false), truth, 0, by_depth_alone());
  ASSERT_TRUE(solution.has_value());
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(solution->information);
  EXPECT_LT(eigen.eigenvalues()(2), 1e-3 * eigen.eigenvalues()(3));
  const Vector6d error = error_of(solution->T_reference_camera, truth);
  EXPECT_LT(std::abs(error(2)), 1e-4) << "towards the wall";
  EXPECT_LT(error.segment<2>(3).norm(), 1e-4) << "tilt";
}

TEST(Icp, IntensitiesConstrainThePoseAtAWall) {
  const auto [truth, solution] = align(wall_scene, small_camera(true), small_motion(), 1e-3, {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 5e-3);
  const auto [unused, depth_alone] =
      align(wall_scene, small_camera(true), small_motion(), 1e-3, by_depth_alone());
  ASSERT_TRUE(depth_alone.has_value());
  EXPECT_GT(error_of(depth_alone->T_reference_camera, truth).norm(), 0.02);
}

TEST(Icp, AChangeOfExposureDoesNotMatter) {
  Random random(3);
  const PinholeCamera camera = small_camera(false);
  const IcpCamera icp = make_icp_camera(Sensor{camera}, {});
  const View a = render(wall_scene, camera, {}, 0, random);
  const View b = render(wall_scene, camera, small_motion(), 0, random);
  const auto solution = align_icp(icp, make_icp_frame(icp, a.depth_m, a.gray),
                                  make_icp_frame(icp, b.depth_m, b.gray + 15), {}, {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, small_motion()).norm(), 5e-3);
}

TEST(Icp, NoSolutionWithoutDepthOrOverlap) {
  Random random(4);
  const PinholeCamera camera = small_camera(false);
  const IcpCamera icp = make_icp_camera(Sensor{camera}, {});
  const View view = render(corner_scene, camera, {}, 0, random);
  const IcpFrame good = make_icp_frame(icp, view.depth_m);
  const IcpFrame empty = make_icp_frame(icp, cv::Mat::zeros(240, 320, CV_32FC1));
  const IcpFrame broken = make_icp_frame(icp, cv::Mat(240, 320, CV_32FC1, cv::Scalar(kNan)));
  EXPECT_FALSE(align_icp(icp, good, empty, {}, {}).has_value());
  EXPECT_FALSE(align_icp(icp, empty, good, {}, {}).has_value());
  EXPECT_FALSE(align_icp(icp, good, broken, {}, {}).has_value());
  const SE3 away{exp_so3({0, 3, 0}), Eigen::Vector3d::Zero()};
  EXPECT_FALSE(align_icp(icp, good, good, away, {}).has_value());
  EXPECT_THROW(make_icp_frame(icp, cv::Mat::zeros(10, 10, CV_32FC1)), std::logic_error);
}

TEST(Icp, AFrameAlignsWithItself) {
  Random random(5);
  const PinholeCamera camera = small_camera(true);
  const IcpCamera icp = make_icp_camera(Sensor{camera}, {});
  const View view = render(corner_scene, camera, {}, 1e-3, random);
  const IcpFrame frame = make_icp_frame(icp, view.depth_m);
  const auto solution = align_icp(icp, frame, frame, {}, {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(solution->T_reference_camera.log().norm(), 1e-6);
  EXPECT_LT(solution->rmse_m, 1e-6);
}

}  // namespace
}  // namespace kinloop
