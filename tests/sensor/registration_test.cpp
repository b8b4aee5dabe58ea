#include "kinloop/sensor/camera/registration.hpp"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/tum_source.hpp"
#include "drivers/image_files/image_file.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

/// A Kinect 2: a wide, low-resolution depth camera next to a high-resolution colour camera.
RgbdCamera kinect2_like(int color_width = 960) {
  RgbdCamera camera;
  PinholeCamera color;
  color.width = 1920, color.height = 1080, color.fx = 1064, color.fy = 1067, color.cx = 983, color.cy = 530;
  color.lens.k1 = 0.03, color.lens.p2 = -0.002;
  camera.color = resized(color, color_width);
  PinholeCamera depth;
  depth.width = 512, depth.height = 424, depth.fx = 366, depth.fy = 365, depth.cx = 253, depth.cy = 201;
  depth.lens.k1 = 0.09, depth.lens.k2 = -0.26, depth.lens.k3 = 0.09;
  camera.depth = depth;
  camera.T_color_depth = {exp_so3({0.01, -0.004, 0.002}), {-0.052, 0.0004, 0.001}};
  return camera;
}

/// n . p = d.
struct Plane {
  Eigen::Vector3d normal;
  double distance_m;

  [[nodiscard]] double depth_at(const PinholeCamera& camera, double x, double y) const {
    return distance_m / normal.dot(camera.unproject(camera.undistort({x, y}), 1));
  }
  /// The same plane with p_other = T * p.
  [[nodiscard]] Plane moved(const SE3& T) const {
    const Eigen::Vector3d n = T.rotation * normal;
    return {n, distance_m + n.dot(T.translation)};
  }
};

cv::Mat depth_of(const Plane& plane, const PinholeCamera& camera) {
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x)
      depth.at<float>(y, x) = static_cast<float>(plane.depth_at(camera, x, y));
  }
  return depth;
}

Plane wall() {
  return {Eigen::Vector3d(0.5, -0.2, -1).normalized(), -2.0};
}

TEST(Registration, IdentityForCoincidentCameras) {
  RgbdCamera camera = kinect2_like(640);
  camera.depth = camera.color;
  camera.T_color_depth = {};
  const cv::Mat depth = depth_of(wall(), camera.color);
  const cv::Mat registered = DepthRegistration(camera)(depth);
  const cv::Rect inside(1, 1, depth.cols - 2, depth.rows - 2);
  EXPECT_LT(cv::norm(depth(inside), registered(inside), cv::NORM_INF), 1e-4);
}

TEST(Registration, GivesTheDepthThatTheColorCameraSees) {
  for (const int width : {480, 960, 1920}) {
    const RgbdCamera camera = kinect2_like(width);
    const cv::Mat registered = DepthRegistration(camera)(depth_of(wall(), *camera.depth));
    const Plane seen = wall().moved(camera.T_color_depth);
    int known = 0;
    double largest_m = 0;
    for (int y = 0; y < registered.rows; ++y) {
      for (int x = 0; x < registered.cols; ++x) {
        const auto z = static_cast<double>(registered.at<float>(y, x));
        if (z == 0) continue;
        ++known;
        largest_m = std::max(largest_m, std::abs(z - seen.depth_at(camera.color, x, y)));
      }
    }
    EXPECT_LT(largest_m, 1e-3) << width;
    // The colour camera has a wider view than the depth camera; between the left and right ends of depth
    // there is no gap.
    EXPECT_GT(known, 0.75 * static_cast<double>(registered.total())) << width;
    const cv::Mat middle =
        registered(cv::Rect(width / 4, registered.rows / 4, width / 2, registered.rows / 2));
    EXPECT_EQ(cv::countNonZero(middle), static_cast<int>(middle.total())) << "holes at " << width;
  }
}

TEST(Registration, TheNearerSurfaceWinsAndEdgesStayEdges) {
  const RgbdCamera camera = kinect2_like();
  const Plane far{{0, 0, 1}, 3.0}, near{{0, 0, 1}, 1.0};
  cv::Mat depth = depth_of(far, *camera.depth);
  depth_of(near, *camera.depth).colRange(200, 300).copyTo(depth.colRange(200, 300));
  const cv::Mat registered = DepthRegistration(camera)(depth);
  const double far_m = far.moved(camera.T_color_depth).depth_at(camera.color, 480, 270);
  const double near_m = near.moved(camera.T_color_depth).depth_at(camera.color, 480, 270);
  int between = 0, near_pixels = 0;
  for (int y = 0; y < registered.rows; ++y) {
    for (int x = 0; x < registered.cols; ++x) {
      const auto z = static_cast<double>(registered.at<float>(y, x));
      if (z > near_m + 0.1 && z < far_m - 0.1) ++between;
      if (z > 0 && z < near_m + 0.1) ++near_pixels;
    }
  }
  EXPECT_EQ(between, 0);
  EXPECT_GT(near_pixels, 80 * 400);
  // To the right of the strip's left edge, what the colour camera sees is either occluded from the depth
  // camera by the strip or the strip itself, never the wall behind it.
  const auto row = registered.rows / 2;
  bool in_strip = false;
  int entered = 0;
  for (int x = 0; x < registered.cols; ++x) {
    const float z = registered.at<float>(row, x);
    const bool now = z > 0 && z < near_m + 0.1;
    entered += now && !in_strip ? 1 : 0;
    in_strip = now;
  }
  EXPECT_EQ(entered, 1) << "the wall is visible through holes in the strip";
}

TEST(Registration, ADepthLensOfTheRationalModelAndAFisheyeAreRegisteredToTheMillimetre) {
  RgbdCamera camera = kinect2_like();
  for (const LensDistortion& lens :
       {LensDistortion{LensModel::kRational, 3.1305770, 2.3249390, 8.1e-05, -5.1e-05, 0.1304156, 3.4586515,
                       3.3501145, 0.6629416},  // of an Azure Kinect
        lens_with(LensModel::kKannalaBrandt, std::array{-0.0065, 0.0421, -0.0396, 0.0069})}) {
    camera.depth->lens = lens;
    const cv::Mat registered = DepthRegistration(camera)(depth_of(wall(), *camera.depth));
    const Plane seen = wall().moved(camera.T_color_depth);
    ASSERT_EQ(registered.size(), cv::Size(960, 540));
    int compared = 0;
    for (int y = 100; y < 440; y += 7) {
      for (int x = 200; x < 760; x += 7) {
        const float depth_m = registered.at<float>(y, x);
        if (depth_m == 0) continue;
        EXPECT_NEAR(depth_m, seen.depth_at(camera.color, x, y), 1e-3) << x << " " << y;
        ++compared;
      }
    }
    EXPECT_GT(compared, 3500);
  }
}

TEST(Registration, UnknownStaysUnknown) {
  const RgbdCamera camera = kinect2_like();
  EXPECT_EQ(cv::countNonZero(DepthRegistration(camera)(cv::Mat(424, 512, CV_32FC1, cv::Scalar(0)))), 0);
  cv::Mat depth(424, 512, CV_32FC1, cv::Scalar(-1));
  depth.row(5).setTo(std::numeric_limits<float>::quiet_NaN());
  depth.row(6).setTo(std::numeric_limits<float>::infinity());
  const cv::Mat registered = DepthRegistration(camera)(depth);
  EXPECT_EQ(cv::countNonZero(registered), 0);
}

TEST(Registration, IgnoresFoldedDistortion) {
  RgbdCamera camera = kinect2_like();
  const cv::Mat depth_m(camera.depth->height, camera.depth->width, CV_32FC1, cv::Scalar(1.5));
  const int seen = cv::countNonZero(DepthRegistration(camera)(depth_m));
  camera.depth->lens.k3 = -4;  // a possible result of ten images
  const int still_seen = cv::countNonZero(DepthRegistration(camera)(depth_m));
  EXPECT_LT(still_seen, seen);
  EXPECT_GT(still_seen, seen / 3) << "the middle is unchanged";
}

TEST(Registration, AResizedCameraSeesTheSame) {
  const PinholeCamera camera = kinect2_like(1920).color, half = resized(camera, 960);
  EXPECT_EQ(half.height, 540);
  const Eigen::Vector3d p(0.3, -0.2, 1.5);
  const Eigen::Vector2d large = camera.distort(camera.project(p)), small = half.distort(half.project(p));
  EXPECT_LT(((large.array() + 0.5) / 2 - 0.5 - small.array()).matrix().norm(), 1e-9);
}

TEST(Registration, FoldersWhoseDepthIsNotRegisteredAreRegisteredOnTheWayIn) {
  const test::SequenceFolder sequence(2);
  sequence.folder.write(
      "camera.yaml",
      "{width: 32, height: 24, fx: 25, fy: 25, cx: 15.5, cy: 11.5, distortion: [0, 0, 0, 0, 0], "
      "depth_scale: 1000, fps: 30, depth_shift_m: 0.5, "
      "depth: {width: 16, height: 12, fx: 12.5, fy: 12.5, cx: 7.5, cy: 5.5, "
      "distortion: [0, 0, 0, 0, 0]}, "
      "T_color_depth: {translation: [0, 0, 0.25], rotation_vector: [0, 0, 0]}}\n");
  for (int i = 0; i < 2; ++i) {
    sequence.folder.write(test::SequenceFolder::depth_name(i),
                          test::encoded(test::make_depth(1000, {16, 12}), ".png"));
  }
  TumSource source(sequence.path());
  const auto frame = source.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth_m.cols, 32);
  EXPECT_FLOAT_EQ(frame->depth_m.at<float>(12, 16), 1.75F);
  EXPECT_TRUE(source.camera().depth) << "so that the run's camera.yaml fits the same folder";
}

/// Frames of a Kinect 1 as recorded, compared with the same frames registered by libfreenect2.
TEST(RealRegistration, AgreesWithLibfreenect2WithinMillimetres) {
  const auto raw = test::shared_data("redkitchen_raw"), other = test::shared_data("redkitchen");
  KINLOOP_SKIP_WITHOUT(raw);
  KINLOOP_SKIP_WITHOUT(other);
  RgbdCamera camera;
  camera.color.width = 640, camera.color.height = 480;
  camera.color.fx = camera.color.fy = 522.07, camera.color.cx = 319.07, camera.color.cy = 237.69;
  PinholeCamera depth = camera.color;
  depth.fx = depth.fy = 585, depth.cx = 320, depth.cy = 240;
  camera.depth = depth;
  camera.T_color_depth = {exp_so3({-0.0007, 0.0002, 0.0012}), {-0.0239, 0.0027, -0.0049}};
  const DepthRegistration registration(camera);
  const cv::Mat ours = registration(read_depth_image(raw / "depth/000310.png", 1000));
  const cv::Mat theirs = read_depth_image(other / "depth/1010.333333.png", 5000);
  const cv::Mat both = (ours > 0) & (theirs > 0);
  cv::Mat difference;
  cv::absdiff(ours, theirs, difference);
  const double compared = cv::countNonZero(both);
  EXPECT_GT(compared, 0.95 * cv::countNonZero(theirs > 0));
  EXPECT_GT(cv::countNonZero(both & (difference < 0.01)), 0.9 * compared);
}

}  // namespace
}  // namespace kinloop
