#include "dense/cloud/color_gains.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/dense/plane_view.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using test::small_camera;
using test::view_of_wall;

constexpr double kPaintedWallZ_m = 1.8;

/// Colours of the wall: patches of 7 cm; red, green and blue each between 60 and 140.
cv::Vec3b wall_color(const Eigen::Vector3d& p) {
  constexpr double kPatch_m = 0.07;
  const auto cell = (p / kPatch_m).array().floor().cast<int64_t>().eval();
  Random random(static_cast<uint64_t>((cell.x() + 500) * 1000 + cell.y() + 500));
  const auto channel = [&] { return static_cast<uint8_t>(60 + random.index(80)); };
  const uint8_t blue = channel(), green = channel(), red = channel();
  return {blue, green, red};
}

/// Views of a painted wall by a passing camera.
struct ExposureScene {
  std::vector<RgbdImages> images;
  std::vector<PosedImage> views;
  DenseCamera camera{.color = small_camera()};

  /// `gain` multiplies red, green and blue.
  void add(const SE3& T_world_camera, const Eigen::Vector3d& gain) {
    RgbdImages seen = view_of_wall(camera.color, T_world_camera, kPaintedWallZ_m, {});
    for (int row = 0; row < seen.color.rows; ++row) {
      for (int col = 0; col < seen.color.cols; ++col) {
        const double z = static_cast<double>(seen.depth_m.at<float>(row, col));
        const cv::Vec3b color =
            wall_color(T_world_camera * camera.color.unproject(Eigen::Vector2d(col, row), z));
        for (int k = 0; k < 3; ++k)
          seen.color.at<cv::Vec3b>(row, col)[k] = cv::saturate_cast<uint8_t>(gain(2 - k) * color[k]);
      }
    }
    views.push_back({images.size(), T_world_camera});
    images.push_back(seen);
  }

  [[nodiscard]] SurfelLoader surfel_loader() const {
    return [this](size_t i) { return extract_surfels(images[i], {camera.color.fx}, {}); };
  }

  [[nodiscard]] std::vector<Eigen::Vector3f> gains(int threads = 1) const {
    return color_gains(surfel_loader(), views, camera, threads);
  }

  [[nodiscard]] ColoredCloud cloud(bool even) const {
    auto exposure_corrected = views;
    const auto factors = gains();
    for (size_t i = 0; even && i < exposure_corrected.size(); ++i)
      exposure_corrected[i].color_gain = factors[i];
    return fuse_surfels(surfel_loader(), exposure_corrected, camera, {}, 1);
  }
};

SE3 pose(size_t i) {
  const auto t = static_cast<double>(i);
  return {exp_so3({0.02 * t, 0.04 * t, 0.1 * t}), {0.15 * t, 0.02 * t, 0}};
}

/// Gains of red, green and blue of view `i`: an exposure and a white balance.
Eigen::Vector3d true_gain(size_t i) {
  Random random(77 + i);
  const double exposure = std::exp(0.35 * random.gaussian());
  const Eigen::Vector2d tint = 0.05 * test::gaussian_vector<2>(random);
  return exposure * Eigen::Vector3d(std::exp(tint.x()), 1, std::exp(tint.y()));
}

ExposureScene disturbed(size_t count) {
  ExposureScene scene;
  for (size_t i = 0; i < count; ++i) scene.add(pose(i), true_gain(i));
  return scene;
}

TEST(ColorGains, AreFoundUpToACommonFactor) {
  constexpr size_t kViews = 10;
  const auto found = disturbed(kViews).gains();
  ASSERT_EQ(found.size(), kViews);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < kViews; ++i) {
    mean.array() += (true_gain(i).array() * found[i].cast<double>().array()).log() / kViews;
    sum.array() += found[i].cast<double>().array().log();
  }
  EXPECT_LT(sum.norm(), 1e-4);
  for (size_t i = 0; i < kViews; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double product = true_gain(i)(k) * static_cast<double>(found[i](k));
      EXPECT_NEAR(std::log(product) - mean(k), 0, 0.02) << i << ", " << k;
    }
  }
}

TEST(ColorGains, AreOneWhereNothingChanges) {
  ExposureScene scene;
  for (size_t i = 0; i < 5; ++i) scene.add(pose(i), {1, 1, 1});
  const auto gains = scene.gains();
  ASSERT_EQ(gains.size(), 5U);
  for (const auto& gain : gains) EXPECT_LT((gain.array() - 1).abs().maxCoeff(), 0.01F);
}

TEST(ColorGains, AreOneWhereNothingIsShared) {
  ExposureScene scene;
  scene.add(pose(0), {1, 1, 1});
  scene.add({exp_so3({0, 0, 0}), {9, 0, 0}}, {0.6, 0.6, 0.6});
  const auto gains = scene.gains();
  ASSERT_EQ(gains.size(), 2U);
  for (const auto& gain : gains) EXPECT_LT((gain.array() - 1).abs().maxCoeff(), 1e-6F);
  EXPECT_TRUE(ExposureScene().gains().empty());
}

TEST(ColorGains, DoNotDependOnThreads) {
  const ExposureScene scene = disturbed(7);
  EXPECT_EQ(scene.gains(1), scene.gains(3));
}

TEST(ColorGains, ColourChangingObjectsAreDownweighted) {
  ExposureScene scene;
  for (size_t i = 0; i < 6; ++i) {
    scene.add(pose(0), {1, 1, 1});
    // A screen, a fifth of the image, that lights up.
    if (i >= 3) scene.images.back().color(cv::Rect(40, 20, 64, 60)).setTo(cv::Scalar(230, 230, 230));
  }
  const auto gains = scene.gains();
  ASSERT_EQ(gains.size(), 6U);
  for (const auto& gain : gains) EXPECT_LT((gain.array() - 1).abs().maxCoeff(), 0.03F);
}

TEST(ColorGains, UndoExposureChanges) {
  ExposureScene steady;
  for (size_t i = 0; i < 8; ++i) steady.add(pose(i), {1, 1, 1});
  const ExposureScene changing = disturbed(8);
  const auto truth = steady.cloud(false);
  const auto error_of = [&](const ColoredCloud& cloud) {
    EXPECT_EQ(cloud.points, truth.points);
    // A common factor is not observable.
    const auto count = static_cast<double>(cloud.size());
    double spread = 0;
    for (size_t k = 0; k < 3; ++k) {
      const auto off = [&](size_t i) {
        return std::log((1.0 + cloud.colors[i][k]) / (1.0 + truth.colors[i][k]));
      };
      double common = 0;
      for (size_t i = 0; i < cloud.size(); ++i) common += off(i) / count;
      for (size_t i = 0; i < cloud.size(); ++i) spread += std::abs(off(i) - common);
    }
    return spread / (3.0 * static_cast<double>(cloud.size()));
  };
  EXPECT_LT(error_of(changing.cloud(true)), 0.3 * error_of(changing.cloud(false)));
}

}  // namespace
}  // namespace kinloop
