#include "dense/surfels/fuse_surfels.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/depth_noise.hpp"
#include "tests/dense/plane_view.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::small_camera;
using test::view_of_wall;

constexpr double kWallZ_m = 1.8;

struct Scene {
  std::vector<RgbdImages> images;
  std::vector<PosedImage> views;
  DenseCamera camera{.color = small_camera()};

  void add(const RgbdImages& seen, const SE3& T_world_camera, const Velocity& velocity = {},
           double depth_stamp_difference_s = 0) {
    views.push_back({images.size(), T_world_camera, velocity, depth_stamp_difference_s});
    images.push_back({seen.color.clone(), seen.depth_m.clone()});
  }

  [[nodiscard]] ColoredCloud fused(const DenseOptions& options = {}, int threads = 1,
                                   const Progress& progress = {}) const {
    const auto load_surfels = [&](size_t i) {
      return extract_surfels(images[i], {camera.color.fx}, options);
    };
    return fuse_surfels(load_surfels, views, camera, options, threads, progress);
  }
};

/// A wall seen by a passing camera.
Scene views_of_wall(size_t count) {
  Scene scene;
  for (size_t i = 0; i < count; ++i) {
    const auto t = static_cast<double>(i);
    const SE3 T_world_camera{exp_so3({0.02 * t, 0.05 * t, 0}), {0.1 * t, 0, 0.03 * t}};
    scene.add(view_of_wall(small_camera(), T_world_camera, kWallZ_m, {30, 100, 200}), T_world_camera);
  }
  return scene;
}

/// Replaces a square of the image, 40 px wide, by another depth and colour.
RgbdImages with_person(const RgbdImages& seen, float depth_m) {
  RgbdImages images{seen.color.clone(), seen.depth_m.clone()};
  const cv::Rect where(60, 40, 40, 40);
  images.depth_m(where).setTo(depth_m);
  images.color(where).setTo(cv::Scalar(0, 0, 255));
  return images;
}

size_t count_near(const ColoredCloud& cloud, float z_m) {
  return static_cast<size_t>(
      std::count_if(cloud.points.begin(), cloud.points.end(),
                    [=](const Eigen::Vector3f& p) { return std::abs(p.z() - z_m) < 0.1F; }));
}

double median_error(const ColoredCloud& cloud, double wall_z_m) {
  std::vector<double> errors;
  for (const auto& p : cloud.points) errors.push_back(std::abs(static_cast<double>(p.z()) - wall_z_m));
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
  return errors.at(errors.size() / 2);
}

void expect_same(const ColoredCloud& a, const ColoredCloud& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.colors, b.colors);
}

TEST(FuseSurfels, EveryPointHasTheNormalOfItsSurfaceTowardsTheCamera) {
  const auto cloud = views_of_wall(4).fused();
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  double sum = 0;
  for (const auto& normal : cloud.normals) {
    EXPECT_NEAR(normal.norm(), 1, 1e-5);
    sum -= static_cast<double>(normal.z());
  }
  EXPECT_GT(sum / static_cast<double>(cloud.size()), std::cos(0.05));
}

TEST(FuseSurfels, AWallIsOneLayerOfPointsOnIt) {
  const auto cloud = views_of_wall(4).fused();
  ASSERT_GT(cloud.size(), 10000U);
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_NEAR(cloud.points[i].z(), kWallZ_m, 2e-4);
    EXPECT_EQ(cloud.colors[i], (Rgb{200, 100, 30}));
  }
}

TEST(FuseSurfels, NoiseIsAveragedAwayAndStillOneLayer) {
  constexpr double kFar_m = 3.5;
  Scene scene;
  Random random(5);
  for (int view = 0; view < 10; ++view) {
    auto seen = view_of_wall(small_camera(), {}, kFar_m, {9, 9, 9});
    for (int i = 0; i < static_cast<int>(seen.depth_m.total()); ++i) {
      auto& depth_m = seen.depth_m.at<float>(i / 160, i % 160);
      depth_m += static_cast<float>(DepthNoise().sigma_m(kFar_m) * random.gaussian());
    }
    scene.add(seen, {});
  }
  const auto cloud = scene.fused();
  EXPECT_LT(median_error(cloud, kFar_m), DepthNoise().sigma_m(kFar_m) / 5);
  const double area_m2 = 160 * 120 * kFar_m * kFar_m / (130 * 131);
  EXPECT_LT(static_cast<double>(cloud.size()), 1.5 * area_m2 / (0.01 * 0.01));
}

TEST(FuseSurfels, DeskewsDelayedRollingShutterDepth) {
  Scene scene;
  scene.camera.depth_delay_s = 0.02;
  scene.camera.readout_s = 0.03;
  const Velocity velocity{{0.1, -0.2, 0.5}, {0.1, 0.6, 0.2}};
  constexpr double kLags_s[] = {-0.015, 0.018};
  for (size_t view = 0; view < 2; ++view) {
    RgbdImages seen{cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(50)), cv::Mat(120, 160, CV_32FC1)};
    for (int row = 0; row < 120; ++row) {
      const double time_s = kLags_s[view] + scene.camera.time_of_row_s(row);
      const SE3 T_world_camera{exp_so3(time_s * velocity.angular_rad_s), time_s * velocity.linear_m_s};
      view_of_wall(small_camera(), T_world_camera, kWallZ_m, {})
          .depth_m.row(row)
          .copyTo(seen.depth_m.row(row));
    }
    scene.add(seen, {}, velocity, kLags_s[view]);
  }
  EXPECT_LT(median_error(scene.fused(), kWallZ_m), 5e-4);
  scene.camera.depth_delay_s = scene.camera.readout_s = 0;
  EXPECT_GT(median_error(scene.fused(), kWallZ_m), 5e-3);
}

TEST(FuseSurfels, CorrectsDepthDeformation) {
  auto scene = views_of_wall(3);
  for (auto& seen : scene.images) seen.depth_m = 1 / (1 / seen.depth_m - 0.01);
  EXPECT_GT(median_error(scene.fused(), kWallZ_m), 0.02);
  scene.camera.inverse_depth_correction(0) = 0.01;
  EXPECT_LT(median_error(scene.fused(), kWallZ_m), 1e-3);
}

TEST(FuseSurfels, CarvesAwayMovingObjectsOnly) {
  const auto empty = view_of_wall(small_camera(), {}, 2.5, {200, 200, 200});
  const auto person = with_person(empty, 1.2F);
  for (const size_t seen : {2, 6}) {
    Scene scene;
    for (size_t i = 0; i < 8; ++i) scene.add(i < seen ? person : empty, {});
    EXPECT_EQ(count_near(scene.fused(), 1.2F) > 0, seen == 6) << seen;
    DenseOptions keep;
    keep.carve = false;
    EXPECT_GT(count_near(scene.fused(keep), 1.2F), 500U);
    // The background is there either way.
    EXPECT_EQ(count_near(scene.fused(), 2.5F), count_near(scene.fused(keep), 2.5F));
  }
}

TEST(FuseSurfels, UnknownDepthDoesNotCarve) {
  const auto person = with_person(view_of_wall(small_camera(), {}, 2.5, {200, 200, 200}), 1.2F);
  auto blind = person;
  blind.depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(0));
  Scene scene;
  for (int i = 0; i < 8; ++i) scene.add(i < 2 ? person : blind, {});
  EXPECT_GT(count_near(scene.fused(), 1.2F), 500U);
}

TEST(FuseSurfels, ColoursAreThoseOfTheSharpestViews) {
  Scene scene;
  Random random(2);
  for (int view = 0; view < 4; ++view) {
    auto seen =
        view_of_wall(small_camera(), {}, kWallZ_m, view == 0 ? cv::Vec3b(0, 0, 150) : cv::Vec3b(150, 0, 0));
    for (int i = 0; view == 0 && i < 160 * 120; ++i) {
      seen.color.at<cv::Vec3b>(i / 160, i % 160)[2] = static_cast<uint8_t>(100 + random.index(100));
    }
    scene.add(seen, {});
  }
  const ColoredCloud fused = scene.fused();
  ASSERT_GT(fused.colors.size(), 1000U);
  for (const Rgb& color : fused.colors) {
    EXPECT_GE(color[0], 95);
    EXPECT_LE(color[2], 5);
  }
}

TEST(FuseSurfels, GivesTheSameBytesWithAnyNumberOfThreads) {
  const Scene scene = views_of_wall(9);
  const auto one = scene.fused();
  for (const int threads : {2, 3, 16}) expect_same(scene.fused({}, threads), one);
}

TEST(FuseSurfels, SlabsDoNotChangeTheBytes) {
  Scene scene = views_of_wall(9);
  // Oblique to all axes, so that it can be split into slabs.
  const SE3 T_new_world{exp_so3({0.5, 0.7, 0.2}), {1, 2, -3}};
  for (auto& view : scene.views) view.T_world_camera = T_new_world * view.T_world_camera;
  DenseOptions little;
  little.fusion_memory_mib = 1;
  int fillings = 0;
  const auto counting = [&](const ProgressReport& now) {
    fillings += now.done == 0 && now.stage == "fusing" ? 1 : 0;
    return true;
  };
  const auto parts = scene.fused(little, 2, counting);
  EXPECT_GT(fillings, 2);
  expect_same(parts, scene.fused());
}

TEST(FuseSurfels, TheMapOfGoodViewsIsNeverEmpty) {
  for (const size_t count : {1, 2, 3, 5}) {
    Scene still;
    for (size_t i = 0; i < count; ++i) still.add(views_of_wall(1).images[0], {});
    EXPECT_GT(still.fused().size(), 10000U) << count;
    EXPECT_GT(views_of_wall(count).fused().size(), 5000U) << count;
  }
  DenseOptions many;
  many.min_observations = 9;
  EXPECT_GT(views_of_wall(3).fused(many).size(), 5000U);
}

TEST(FuseSurfels, KeepsSurfacesOnlyOneViewCovered) {
  Scene scene = views_of_wall(1);
  const size_t one = scene.fused().size();
  // A second view in another direction adds points and removes none.
  const SE3 T_world_camera{exp_so3({0, 0, 0}), {5, 0, 0}};
  scene.add(view_of_wall(small_camera(), T_world_camera, kWallZ_m, {30, 100, 200}), T_world_camera);
  EXPECT_NEAR(static_cast<double>(scene.fused().size()), 2.0 * static_cast<double>(one),
              0.02 * 2.0 * static_cast<double>(one));
}

TEST(FuseSurfels, DropsSurfacesTooFewCoveringViewsObserved) {
  const auto empty = view_of_wall(small_camera(), {}, 2.5, {200, 200, 200});
  const auto person = with_person(empty, 1.2F);
  auto unknown = person;
  unknown.depth_m = person.depth_m.clone();
  unknown.depth_m.setTo(0, person.depth_m < 2);
  Scene scene;
  for (int i = 0; i < 5; ++i) scene.add(i < 2 ? person : unknown, {});
  DenseOptions options;
  for (const int views : {1, 2, 3, 4}) {
    options.min_observations = views;
    EXPECT_EQ(count_near(scene.fused(options), 1.2F) > 500, views <= 2) << views;
    EXPECT_GT(count_near(scene.fused(options), 2.5F), 10000U);
  }
}

TEST(FuseSurfels, ManyPixelsOfOneViewAreOneObservation) {
  const auto empty = view_of_wall(small_camera(), {}, 2.5, {200, 200, 200});
  auto unknown = empty;
  unknown.depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(0));
  Scene scene;
  scene.add(empty, {});
  scene.add(unknown, {});
  DenseOptions coarse;
  coarse.voxel_m = 0.2;
  EXPECT_EQ(scene.fused(coarse).size(), 0U);
}

TEST(FuseSurfels, EmptyInputGivesEmptyCloud) {
  EXPECT_EQ(Scene().fused({}, 2).size(), 0U);
}

TEST(FuseSurfels, StopsWhenAskedTo) {
  const Scene scene = views_of_wall(4);
  DenseOptions options;
  options.min_observations = 1;
  const auto first = scene.fused(options, 1, [](const ProgressReport& now) { return now.done < 1; });
  EXPECT_GT(first.size(), 0U);
  EXPECT_LT(first.size(), scene.fused(options).size());
}

TEST(FuseSurfels, ViewsOfARealKitchenAgree) {
  const auto folder = test::shared_data("redkitchen");
  KINLOOP_SKIP_WITHOUT(folder);
  TumSource source(folder);
  const auto truth = source.info().ground_truth;
  Scene scene;
  scene.camera.color = source.camera().color;
  constexpr int kFrames = 31, kStep = 10;
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    if (i % kStep != 0) continue;
    const auto pose = pose_at(truth, frame->stamp_ns, kNsPerSecond / 10);
    ASSERT_TRUE(pose);
    scene.add({frame->color.bgr(), frame->depth_m}, *pose);
  }
  DenseOptions once;
  once.min_observations = 1;
  const auto seen = scene.fused(once, 2), again = scene.fused({}, 2);
  // More than half of what overlapping views see falls into the same cells of some centimetres.
  EXPECT_GT(again.size(), 10000U);
  EXPECT_GT(2.5 * static_cast<double>(again.size()), static_cast<double>(seen.size()));
}

}  // namespace
}  // namespace kinloop
