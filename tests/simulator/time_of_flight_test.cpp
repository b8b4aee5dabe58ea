// Simulated time of flight compared with its own equations.

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "simulator/sensors/depth_models.hpp"

namespace kinloop::sim {
namespace {

/// A white wall straight ahead of a camera whose rays all have length `range_per_depth` at depth 1.
TimeOfFlightRays white_wall(float depth_m, float reflectance = 1, int samples = 1,
                            float range_per_depth = 1) {
  const cv::Size size(160, 120);
  const int type = CV_32FC(samples);
  return {{cv::Mat(size, type, cv::Scalar::all(depth_m)), cv::Mat(size, type, cv::Scalar::all(1)),
           cv::Mat(size, type, cv::Scalar::all(reflectance))},
          cv::Mat(size, CV_32FC1, cv::Scalar(range_per_depth)),
          {}};
}

struct WallErrors {
  double mean_m, sigma_m, lost;
};

/// WallErrors of depth that should be `depth_m` everywhere.
WallErrors wall_errors(const cv::Mat& measured, double depth_m) {
  const cv::Mat known = measured > 0;
  cv::Scalar mean, sigma;
  cv::meanStdDev(measured, mean, sigma, known);
  return {mean[0] - depth_m, sigma[0], 1 - cv::countNonZero(known) / static_cast<double>(measured.total())};
}

TEST(TimeOfFlightModel, NoiseGrowsWithDistanceAndLittleReflectance) {
  const TimeOfFlightNoise noise;
  for (const float depth_m : {0.8F, 2.0F, 4.0F}) {
    for (const float reflectance : {1.0F, 0.2F}) {
      const double z = static_cast<double>(depth_m);
      const double model_m =
          std::hypot(noise.noise_floor_m, noise.noise_per_m * z * z / static_cast<double>(reflectance));
      const WallErrors e = wall_errors(measured_depth(white_wall(depth_m, reflectance), noise, 7, 1), z);
      EXPECT_NEAR(e.sigma_m / model_m, 1, 0.05) << depth_m << " m, " << reflectance;
      EXPECT_LT(std::abs(e.mean_m), 0.05 * model_m) << depth_m << " m, " << reflectance;
      EXPECT_EQ(e.lost, 0);
    }
  }
}

TEST(TimeOfFlightModel, NoiseIsAlongTheRay) {
  const TimeOfFlightNoise noise;
  constexpr float kOblique = 1.25F;
  const WallErrors e = wall_errors(measured_depth(white_wall(2, 1, 1, kOblique), noise, 7, 1), 2);
  const double range_m = 2.5;
  EXPECT_NEAR(e.sigma_m * 1.25, std::hypot(noise.noise_floor_m, noise.noise_per_m * range_m * range_m), 1e-4);
}

TEST(TimeOfFlightModel, SurfacesThatReturnTooLittleLightAreUnknown) {
  EXPECT_EQ(wall_errors(measured_depth(white_wall(3, 0.01F), {}, 1, 1), 3).lost, 1);
  TimeOfFlightRays glass = white_wall(2);
  glass.exact.cosine.setTo(0);
  EXPECT_EQ(wall_errors(measured_depth(glass, {}, 1, 1), 2).lost, 1);
}

TEST(TimeOfFlightModel, DepthOutsideTheRangeIsUnknown) {
  EXPECT_EQ(wall_errors(measured_depth(white_wall(0.4F), {}, 1, 1), 0.4).lost, 1);
  EXPECT_EQ(wall_errors(measured_depth(white_wall(5), {}, 1, 1), 5).lost, 1);
}

TEST(TimeOfFlightModel, DepthBeyondTheUnambiguousRangeWraps) {
  TimeOfFlightNoise noise;
  noise.noise_per_m = 1e-6;
  const double depth_m = kUnambiguousRange_m + 2;
  const WallErrors e = wall_errors(measured_depth(white_wall(static_cast<float>(depth_m)), noise, 1, 1), 2);
  EXPECT_EQ(e.lost, 0);
  EXPECT_NEAR(e.mean_m, 0, 1e-3);
}

TEST(TimeOfFlightModel, FlyingPixelsLieBetweenBothSurfaces) {
  TimeOfFlightNoise noise;
  noise.noise_floor_m = noise.noise_per_m = 0;
  float before_m = 1;
  for (int far_samples = 1; far_samples < 4; ++far_samples) {
    TimeOfFlightRays view = white_wall(1, 1, 4);
    for (int i = 0; i < far_samples; ++i) {
      for (auto it = view.exact.depth_m.begin<cv::Vec4f>(); it != view.exact.depth_m.end<cv::Vec4f>(); ++it)
        (*it)[i] = 3;
    }
    const float between_m = measured_depth(view, noise, 1, 1).at<float>(60, 80);
    EXPECT_GT(between_m, before_m) << far_samples;  // the more of the far surface, the farther
    EXPECT_LT(between_m, 3);
    before_m = between_m;
  }
}

TEST(TimeOfFlightModel, AFlyingPixelIsNearerToTheBrighterSurface) {
  TimeOfFlightNoise noise;
  noise.noise_floor_m = noise.noise_per_m = 0;
  const auto mixed_m = [&](float near_reflectance) {
    TimeOfFlightRays view = white_wall(2, near_reflectance, 4);
    view.exact.depth_m.setTo(cv::Scalar(2, 2, 2.5, 2.5));
    view.exact.reflectance.setTo(cv::Scalar(near_reflectance, near_reflectance, 0.5, 0.5));
    return measured_depth(view, noise, 1, 1).at<float>(60, 80);
  };
  EXPECT_GT(mixed_m(0.1F), mixed_m(0.5F) + 0.05F);
}

/// Walls on the left and straight ahead that meet in a corner, or that ahead alone.
Scene white_corner(bool left_wall) {
  const auto box = [](const Eigen::Vector3f& center, const Eigen::Vector3f& half) {
    Primitive wall;
    wall.center = center;
    wall.half = half;
    return wall;
  };
  std::vector<Primitive> walls{box({0, 3.05F, 0}, {4, 0.05F, 3})};
  if (left_wall) walls.push_back(box({-1.05F, 1, 0}, {0.05F, 2, 3}));
  return {walls, {Texture(cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(220)))}, {}, 1};
}

cv::Mat corner_error_m(bool left_wall, int threads) {
  const PinholeCamera camera{256, 212, 183, 183, 127.5, 105.5, {}};
  Eigen::Matrix3d R;  // looks along y, z is up
  R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Scene scene = white_corner(left_wall);
  return multipath_error_m(Moment(scene, 0), camera, {Eigen::Quaterniond(R), {0, 0, 0}}, threads);
}

TEST(Multipath, RoundsTheCornerOfTwoWalls) {
  const cv::Mat error_m = corner_error_m(true, 1);
  const int corner = static_cast<int>(127.5 - 183 / 3.0);  // column of the corner, which is 3 m away
  const float near_m = error_m.at<float>(106, corner + 8), far_m = error_m.at<float>(106, 220);
  EXPECT_GT(near_m, 0.005F);
  EXPECT_LT(near_m, 0.2F);
  EXPECT_LT(std::abs(far_m), near_m / 2);
}

TEST(Multipath, APlaneAloneHasNone) {
  EXPECT_LT(cv::norm(corner_error_m(false, 1), cv::NORM_INF), 1e-5);
}

TEST(Multipath, DoesNotDependOnTheNumberOfThreads) {
  EXPECT_EQ(cv::norm(corner_error_m(true, 1), corner_error_m(true, 3), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace kinloop::sim
