#include "dense/surfels/image_surfels.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/sensor/depth_noise.hpp"
#include "tests/dense/plane_view.hpp"

namespace kinloop {
namespace {

using test::small_camera;
using test::view_of_wall;

ImageSurfels extract(const RgbdImages& images, const DenseOptions& options = {}) {
  return extract_surfels(images, {small_camera().fx}, options);
}

size_t pixel_count(const ImageSurfels& surfels) {
  size_t count = 0;
  for (const auto& point : surfels.points) count += point.pixels;
  return count;
}

TEST(ImageSurfels, ComesBackFromItsBytesAsItWas) {
  const auto surfels = extract(view_of_wall(small_camera(), {exp_so3({0.1, 0.3, 0}), {}}, 2, {1, 2, 3}));
  const auto bytes = to_bytes(surfels);
  const auto back = surfels_from_bytes(bytes);
  EXPECT_EQ(back.points.size(), surfels.points.size());
  EXPECT_EQ(back.nearest, surfels.nearest);
  EXPECT_EQ(to_bytes(back), bytes);
  EXPECT_THROW(surfels_from_bytes(std::span(bytes).first(bytes.size() - 1)), std::logic_error);
  EXPECT_THROW(surfels_from_bytes({}), std::logic_error);
}

TEST(ImageSurfels, ThinnedTheyStillCoverTheImage) {
  const auto surfels = extract(view_of_wall(small_camera(), {}, 2, {1, 2, 3}));
  for (const size_t most : {size_t{50}, size_t{1000}, surfels.points.size() + 1}) {
    const auto some = thinned(surfels, most);
    EXPECT_LE(some.points.size(), most);
    EXPECT_GE(2 * some.points.size() + 2, std::min(most, surfels.points.size()));
    EXPECT_LT(some.points.front().row, 8 * some.pixel_steps);
    EXPECT_GT(some.points.back().row, 100 * some.pixel_steps);
  }
}

TEST(ImageSurfels, EveryUsablePixelBelongsToOnePoint) {
  for (const double wall_m : {0.5, 1.5, 3.5}) {
    const auto surfels = extract(view_of_wall(small_camera(), {}, wall_m, {1, 2, 3}));
    EXPECT_EQ(pixel_count(surfels), 156U * 116U) << wall_m;
  }
}

TEST(ImageSurfels, NearSurfacesNeedFewerPointsThanPixels) {
  const auto near = extract(view_of_wall(small_camera(), {}, 0.5, {1, 2, 3}));
  EXPECT_LT(near.points.size(), 156U * 116U / 3);
}

TEST(ImageSurfels, PointsLieOnTheSurfaceAndKnowItsSlope) {
  // n p = d; inverse depth is n (x, y, 1) / d along a ray.
  const SE3 T_world_camera{exp_so3({0.2, -0.4, 0}), {}};
  const Eigen::Vector3d n = T_world_camera.R().transpose() * Eigen::Vector3d::UnitZ() / 1.7;
  const auto surfels = extract(view_of_wall(small_camera(), T_world_camera, 1.7, {1, 2, 3}));
  ASSERT_GT(surfels.points.size(), 1000U);
  for (const auto& point : surfels.points) {
    const Eigen::Vector2d pixel(point.col, point.row);
    const double expected = n.dot(small_camera().unproject(pixel / surfels.pixel_steps, 1));
    EXPECT_NEAR(static_cast<double>(point.inverse_depth), expected, 1e-3 * expected);
    EXPECT_NEAR(static_cast<float>(point.slope_x) / kSlopeSteps, n.x() / expected, 0.05);
    EXPECT_NEAR(static_cast<float>(point.slope_y) / kSlopeSteps, n.y() / expected, 0.05);
  }
}

TEST(ImageSurfels, PositionsOfWideAndHighImagesAreRight) {
  for (const cv::Size size :
       {cv::Size(1024, 20), cv::Size(1920, 20), cv::Size(20, 1300), cv::Size(8000, 20)}) {
    // Inverse depth tells where each pixel is.
    const auto depth_at = [](double col, double row) { return 1 + (col + row) / 4000; };
    RgbdImages images{cv::Mat(size, CV_8UC3, cv::Scalar::all(9)), cv::Mat(size, CV_32FC1)};
    for (int row = 0; row < size.height; ++row) {
      for (int col = 0; col < size.width; ++col)
        images.depth_m.at<float>(row, col) = static_cast<float>(depth_at(col, row));
    }
    const auto surfels = extract_surfels(images, {1000}, {});
    const int steps = surfels.pixel_steps;
    int furthest = 0;
    for (const Surfel& point : surfels.points) {
      const double col = static_cast<double>(point.col) / steps, row = static_cast<double>(point.row) / steps;
      EXPECT_NEAR(1 / static_cast<double>(point.inverse_depth), depth_at(col, row), 3e-3) << size;
      furthest = std::max(furthest, (point.col + point.row) / steps);
    }
    EXPECT_GT(furthest, size.width + size.height - 16) << size;
    EXPECT_EQ(surfels_from_bytes(to_bytes(surfels)).pixel_steps, steps);
  }
}

TEST(ImageSurfels, NoiseIsSmoothedAndEdgesAreNot) {
  auto images = view_of_wall(small_camera(), {}, 3, {1, 2, 3});
  Random random(1);
  for (int i = 0; i < 160 * 120; ++i) {
    auto& depth_m = images.depth_m.at<float>(i / 160, i % 160);
    if (i % 160 < 80) depth_m = 2;
    const auto z = static_cast<double>(depth_m);
    depth_m = static_cast<float>(z + DepthNoise().sigma_m(z) * random.gaussian());
  }
  double squares = 0;
  const auto surfels = extract(images);
  for (const auto& point : surfels.points) {
    const double truth = point.col < 80 * surfels.pixel_steps ? 1 / 2.0 : 1 / 3.0;
    squares += std::pow(static_cast<double>(point.inverse_depth) - truth, 2);
  }
  const double rms = std::sqrt(squares / static_cast<double>(surfels.points.size()));
  EXPECT_LT(rms, 0.45 * DepthNoise().coefficient_per_m);
}

TEST(ImageSurfels, NoiseOfTimeOfFlightIsSmoothedAtEveryDistance) {
  const DepthNoise noise = DepthNoise::of(2e-3, 0.3e-3);
  for (const double wall_m : {0.6, 3.5}) {
    auto images = view_of_wall(small_camera(), {}, wall_m, {1, 2, 3});
    Random random(1);
    for (int i = 0; i < 160 * 120; ++i) {
      auto& depth_m = images.depth_m.at<float>(i / 160, i % 160);
      depth_m += static_cast<float>(noise.sigma_m(wall_m) * random.gaussian());
    }
    double squares_m2 = 0;
    const auto surfels = extract_surfels(images, {small_camera().fx, noise}, {});
    for (const auto& point : surfels.points)
      squares_m2 += std::pow(1 / static_cast<double>(point.inverse_depth) - wall_m, 2);
    const double rms_m = std::sqrt(squares_m2 / static_cast<double>(surfels.points.size()));
    EXPECT_LT(rms_m, 0.5 * noise.sigma_m(wall_m)) << wall_m;
  }
}

TEST(ImageSurfels, OutsideTheRangeThereIsNothing) {
  for (const double wall_m : {0.2, 9.0}) {
    EXPECT_TRUE(extract(view_of_wall(small_camera(), {}, wall_m, {})).points.empty());
  }
  auto images = view_of_wall(small_camera(), {}, 1, {});
  images.depth_m.setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(extract(images).points.empty());
}

TEST(ImageSurfels, FlyingPixelsBetweenTwoSurfacesAreLeftOut) {
  auto images = view_of_wall(small_camera(), {}, 3, {});
  images.depth_m.colRange(0, 80).setTo(1.0F);
  images.depth_m.col(80).setTo(2.0F);  // an intermediate depth
  const ImageSurfels surfels = extract(images);
  ASSERT_GT(surfels.points.size(), 100U);
  for (const auto& point : surfels.points) {
    const float z = 1 / point.inverse_depth;
    EXPECT_TRUE(std::abs(z - 1) < 0.01F || std::abs(z - 3) < 0.01F) << z;
  }
}

TEST(ImageSurfels, SurfacesSeenAtAGrazingAngleAreLeftOut) {
  for (const auto& [angle_deg, seen] : {std::pair(60.0, true), std::pair(87.0, false)}) {
    // A wall through (0, 0, 1.5) m, rotated about the image's columns.
    RgbdImages images{cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(9)), cv::Mat(120, 160, CV_32FC1)};
    for (int col = 0; col < 160; ++col) {
      const double x = (col - 79.5) / 130;
      images.depth_m.col(col).setTo(static_cast<float>(1.5 / (1 - x * std::tan(angle_deg * M_PI / 180))));
    }
    size_t middle = 0;
    const auto surfels = extract(images);
    for (const auto& point : surfels.points) {
      if (std::abs(point.col / surfels.pixel_steps - 79) < 2) middle += point.pixels;
    }
    EXPECT_EQ(middle > 0, seen) << angle_deg << " degrees";
  }
}

TEST(ImageSurfels, HolesBesideASurfaceDoNotMakeItAnEdge) {
  auto images = view_of_wall(small_camera(), {}, 1.5, {});
  images.depth_m.colRange(70, 90).setTo(0.0F);
  EXPECT_EQ(pixel_count(extract(images)), (156U - 20U) * 116U);
}

TEST(ImageSurfels, TilesStoreTheirNearestDepth) {
  auto images = view_of_wall(small_camera(), {}, 2.5, {});
  images.depth_m.at<float>(5, 6) = 1.25F;
  images.depth_m.at<float>(9, 10) = 0;
  const auto surfels = extract(images);
  ASSERT_EQ(surfels.nearest.size(), 40U * 30U);
  EXPECT_NEAR(surfels.nearest[0] * kTileStep_per_m, 1 / 2.5, kTileStep_per_m);
  EXPECT_NEAR(surfels.nearest[41] * kTileStep_per_m, 1 / 1.25, kTileStep_per_m);
  EXPECT_EQ(surfels.nearest[2 * 40 + 2], 0);
}

}  // namespace
}  // namespace kinloop
