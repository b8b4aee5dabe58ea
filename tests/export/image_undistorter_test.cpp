#include "tools/export/sparse_model/image_undistorter.hpp"

#include <array>

#include <gmock/gmock.h>

#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

constexpr LensDistortion kKinectLens{LensModel::kBrownConrady, 0.26, -0.95, -0.005, 0.0026, 1.16};

DenseCamera camera_with(const LensDistortion& lens) {
  DenseCamera camera;
  camera.color = {640, 480, 517.3, 516.5, 318.6, 255.3, lens};
  return camera;
}

std::vector<LensDistortion> lenses_of_every_model() {
  return {kKinectLens,
          lens_with(LensModel::kRational, std::array{0.5, -2.6, 0.0005, -0.0002, 1.5, 0.38, -2.4, 1.4}),
          lens_with(LensModel::kKannalaBrandt, std::array{-0.0065, 0.0421, -0.0396, 0.0069})};
}

Velocity turning() {
  return {Eigen::Vector3d::Zero(), {0.3, -0.8, 0.5}};
}

TEST(ImageUndistorter, DistortInvertsUndistort) {
  for (const LensDistortion& lens : lenses_of_every_model()) {
    const ImageUndistorter undistorter(camera_with(lens), 0.03);
    for (double y = 5; y < 480; y += 47) {
      for (double x = 5; x < 640; x += 63) {
        const Eigen::Vector2d pixel = undistorter.undistort({x, y}, turning());
        EXPECT_LT((undistorter.distort(pixel, turning()) - Eigen::Vector2d(x, y)).norm(), 1e-3)
            << name_of(lens.model) << " " << x << " " << y;
      }
    }
  }
}

TEST(ImageUndistorter, EveryPixelComesFromInsideTheRawImage) {
  auto lenses = lenses_of_every_model();
  lenses.push_back({LensModel::kBrownConrady, -0.15});  // barrel
  lenses.push_back({LensModel::kBrownConrady, 0.1});    // pincushion
  for (const LensDistortion& lens : lenses) {
    DenseCamera camera;
    camera.color = {320, 240, 260, 261, 158, 122, lens};
    const ImageUndistorter undistorter(camera);
    const cv::Mat raw = undistorter.raw_pixels({});
    ASSERT_GT(raw.total(), 320U * 240 / 4) << name_of(lens.model);
    for (int row = 0; row < raw.rows; ++row) {
      for (int col = 0; col < raw.cols; ++col) {
        const auto& at = raw.at<cv::Vec2f>(row, col);
        ASSERT_TRUE(at[0] >= -0.01 && at[1] >= -0.01 && at[0] <= 319.01 && at[1] <= 239.01)
            << name_of(lens.model);
      }
    }
  }
}

TEST(ImageUndistorter, OfAFisheyeImageTheMiddleIsKept) {
  DenseCamera camera;  // 160 degrees over the width
  camera.color = {1280, 960, 458, 459, 644, 478, lenses_of_every_model().back()};
  const ImageUndistorter undistorter(camera);
  const PinholeCamera& pinhole = undistorter.pinhole();
  EXPECT_GT(pinhole.width, camera.color.width);
  EXPECT_LE(pinhole.width, 2 * camera.color.width);
  EXPECT_LE(pinhole.height, 2 * camera.color.height);
  const Eigen::Vector2d corner(pinhole.width - 1, 0);
  EXPECT_TRUE(camera.color.contains(undistorter.distort(corner, {})));
  EXPECT_LT((undistorter.undistort(undistorter.distort(corner, {}), {}) - corner).norm(), 1e-3);
}

TEST(ImageUndistorter, TurningDuringTheReadoutIsRemoved) {
  // A ray that is still in the world, seen in a late row by a camera that turns.
  DenseCamera camera;
  camera.color = {640, 480, 500, 500, 320, 240, {}};
  const double readout_s = 0.03;
  const ImageUndistorter undistorter(camera, readout_s);
  const Eigen::Vector3d ray_at_stamp(0.1, 0.35, 1);
  double row = 0;
  Eigen::Vector2d raw;
  for (int round = 0; round < 20; ++round) {
    raw = camera.color.project(
        point_in_later_camera(ray_at_stamp, turning(), readout_s * (row / camera.color.height - 0.5)));
    row = raw.y();
  }
  const Eigen::Vector2d expected = undistorter.pinhole().project(ray_at_stamp);
  EXPECT_GT((raw - camera.color.project(ray_at_stamp)).norm(), 2);
  EXPECT_LT((undistorter.undistort(raw, turning()) - expected).norm(), 0.1);
}

TEST(ImageUndistorter, RejectsDistortionThatCannotBeInverted) {
  DenseCamera camera;
  camera.color = {640, 480, 500, 500, 320, 240, {LensModel::kBrownConrady, -2}};
  EXPECT_THAT(test::input_error([&] { const ImageUndistorter undistorter(camera); }),
              testing::HasSubstr("check its calibration"));
}

TEST(ImageUndistorter, UndistortsWhatTheLensBent) {
  // A chequerboard of the pinhole camera, drawn through the lens.
  const DenseCamera camera = camera_with(kKinectLens);
  const auto board = [](double x, double y) {
    return (static_cast<int>(x + 800) / 40 + static_cast<int>(y + 800) / 40) % 2 == 0 ? 220 : 30;
  };
  cv::Mat raw(480, 640, CV_8UC3);
  for (int row = 0; row < raw.rows; ++row) {
    for (int col = 0; col < raw.cols; ++col) {
      const Eigen::Vector2d ideal = camera.color.undistort({col, row});
      raw.at<cv::Vec3b>(row, col) = cv::Vec3b::all(static_cast<uint8_t>(board(ideal.x(), ideal.y())));
    }
  }
  const ImageUndistorter undistorter(camera);
  const cv::Mat image = undistorter.color(raw, undistorter.raw_pixels({}));
  ASSERT_GT(image.total(), raw.total() / 2);
  const double shift_x = camera.color.cx - undistorter.pinhole().cx;
  const double shift_y = camera.color.cy - undistorter.pinhole().cy;
  const auto near_edge = [](double at) {
    constexpr double kMarginPx = 3;
    return std::abs(std::remainder(at, 40)) < kMarginPx;
  };
  for (int row = 0; row < image.rows; ++row) {
    for (int col = 0; col < image.cols; ++col) {
      const double x = col + shift_x, y = row + shift_y;
      if (near_edge(x) || near_edge(y)) continue;
      ASSERT_EQ(image.at<cv::Vec3b>(row, col)[0], board(x, y)) << col << " " << row;
    }
  }
}

}  // namespace
}  // namespace kinloop
