#include "kinloop/dense/fuse_keyframes.hpp"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "kinloop/base/random.hpp"
#include "kinloop/base/time.hpp"
#include "kinloop/dense/voxel_grid.hpp"
#include "kinloop/sensor/tum_source.hpp"
#include "tests/dense/plane_view.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::small_camera;
using test::view_of_wall;

struct Scene {
  KeyframeImages images;
  std::vector<PosedImage> views;
};

/// A wall that a camera passes by, in a colour that changes from view to view.
Scene views_of_wall(size_t count) {
  Scene scene;
  for (size_t i = 0; i < count; ++i) {
    const auto t = static_cast<double>(i);
    const SE3 T_world_camera{exp_so3({0.02 * t, 0.05 * t, 0}), {0.1 * t, 0, 0.03 * t}};
    const cv::Vec3b bgr(static_cast<uint8_t>(20 * i), 100, 200);
    const auto seen = view_of_wall(small_camera(), T_world_camera, 1.8, bgr);
    scene.views.push_back({scene.images.add(seen.color, seen.depth_m), T_world_camera});
  }
  return scene;
}

void expect_same(const ColoredCloud& a, const ColoredCloud& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.colors, b.colors);
}

TEST(FuseKeyframes, GivesTheMeansOfAllPixelsAsPlainSumsDo) {
  const Scene scene = views_of_wall(4);
  DenseOptions options;
  options.voxel_m = 0.02;
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), color = Eigen::Vector3d::Zero();
    double pixels = 0;
    std::map<size_t, int> views;
  };
  std::map<std::array<long, 3>, Sum> sums;
  for (const auto& view : scene.views) {
    const auto seen = scene.images.load(view.image);
    for (int row = 2; row < 118; ++row) {
      for (int col = 2; col < 158; ++col) {
        const double z = static_cast<double>(seen.depth_m.at<float>(row, col));
        if (z < options.min_m || z > options.max_m) continue;
        const Eigen::Vector3d p =
            view.T_world_camera * small_camera().unproject(Eigen::Vector2d(col, row), z);
        const auto voxel = [&](int axis) { return std::lround(std::floor(p[axis] / options.voxel_m)); };
        auto& sum = sums[{voxel(2), voxel(1), voxel(0)}];
        const auto& bgr = seen.color.at<cv::Vec3b>(row, col);
        sum.point += p;
        sum.color += Eigen::Vector3d(bgr[2], bgr[1], bgr[0]);
        sum.pixels += 1;
        sum.views[view.image] = 1;
      }
    }
  }
  std::erase_if(sums, [](const auto& entry) { return entry.second.views.size() < 2; });

  const auto cloud = fuse_keyframes(scene.images, scene.views, small_camera(), options, 1);
  // Rays are kept as floats: a pixel on the border of two voxels may go to the other.
  ASSERT_NEAR(static_cast<double>(cloud.size()), static_cast<double>(sums.size()),
              0.005 * static_cast<double>(sums.size()));
  size_t agreeing = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = cloud.points[i].cast<double>();
    const auto voxel = [&](int axis) { return std::lround(std::floor(p[axis] / options.voxel_m)); };
    const auto found = sums.find({voxel(2), voxel(1), voxel(0)});
    if (found == sums.end()) continue;
    const Sum& sum = found->second;
    const bool near = (sum.point / sum.pixels - p).norm() < 1e-3 * options.voxel_m * 5;
    const bool alike = std::abs(sum.color.z() / sum.pixels - cloud.colors[i][2]) <= 0.51;
    agreeing += near && alike ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(agreeing), 0.98 * static_cast<double>(cloud.size()));
}

TEST(FuseKeyframes, GivesTheSameBytesWithAnyNumberOfThreads) {
  const Scene scene = views_of_wall(9);
  const auto one = fuse_keyframes(scene.images, scene.views, small_camera(), {}, 1);
  ASSERT_GT(one.size(), 1000U);
  for (const int threads : {2, 3, 16}) {
    expect_same(fuse_keyframes(scene.images, scene.views, small_camera(), {}, threads), one);
  }
}

TEST(FuseKeyframes, TheOrderOfTheViewsDoesNotMatter) {
  Scene scene = views_of_wall(6);
  const auto forward = fuse_keyframes(scene.images, scene.views, small_camera(), {}, 2);
  std::reverse(scene.views.begin(), scene.views.end());
  expect_same(fuse_keyframes(scene.images, scene.views, small_camera(), {}, 2), forward);
}

TEST(FuseKeyframes, DropsWhatTooFewViewsSaw) {
  const Scene scene = views_of_wall(3);
  DenseOptions options;
  size_t fewer = SIZE_MAX;
  for (const int views : {1, 2, 3}) {
    options.min_observations = views;
    const size_t size = fuse_keyframes(scene.images, scene.views, small_camera(), options, 1).size();
    EXPECT_LT(size, fewer);
    fewer = size;
  }
  options.min_observations = 4;
  EXPECT_EQ(fuse_keyframes(scene.images, scene.views, small_camera(), options, 1).size(), 0U);
}

TEST(FuseKeyframes, ManyPixelsOfOneViewAreOneObservation) {
  const Scene scene = views_of_wall(1);
  DenseOptions coarse;
  coarse.voxel_m = 0.2;
  EXPECT_EQ(fuse_keyframes(scene.images, scene.views, small_camera(), coarse, 1).size(), 0U);
}

TEST(FuseKeyframes, OfNothingIsNothing) {
  EXPECT_EQ(fuse_keyframes({}, {}, small_camera(), {}, 2).size(), 0U);
}

TEST(FuseKeyframes, StopsWhenAskedTo) {
  const Scene scene = views_of_wall(4);
  DenseOptions options;
  options.min_observations = 1;
  const auto all = fuse_keyframes(scene.images, scene.views, small_camera(), options, 1);
  const auto first = fuse_keyframes(scene.images, scene.views, small_camera(), options, 1,
                                    [](const ProgressReport& now) { return now.done < 1; });
  EXPECT_GT(first.size(), 0U);
  EXPECT_LT(first.size(), all.size());
}

TEST(VoxelGrid, MeansOutliveMorePixelsThanItsSumsHold) {
  VoxelGrid grid;
  VoxelSample sample;
  sample.key = 77;
  sample.pixels = 1U << 19;
  sample.steps = {200U << 19, 10U << 19, 255U << 19};
  sample.colors = {255U << 19, 0, 31U << 19};
  for (uint32_t view = 0; view < 100; ++view) grid.add(sample, view);
  ASSERT_EQ(grid.voxels().size(), 1U);
  EXPECT_EQ(mean_color(grid.voxels()[0]), (Rgb{255, 0, 31}));
  EXPECT_EQ(grid.voxels()[0].views, 100);
}

TEST(VoxelGrid, FindsEveryKeyAgain) {
  VoxelGrid grid;
  Random random(3);
  std::map<VoxelKey, uint32_t> expected;
  for (uint32_t i = 0; i < 50000; ++i) {
    VoxelSample sample;
    sample.key = random.index(200) << 21 | random.index(100);
    sample.pixels = 1 + random.index(3);
    grid.add(sample, i);
    expected[sample.key] += sample.pixels;
  }
  ASSERT_EQ(grid.voxels().size(), expected.size());
  for (const Voxel& voxel : grid.voxels()) EXPECT_EQ(voxel.pixels, expected.at(voxel.key));
}

TEST(FuseKeyframes, ViewsOfARealKitchenAgree) {
  const auto folder = test::shared_data("redkitchen");
  KINLOOP_SKIP_WITHOUT(folder);
  TumSource source(folder);
  const auto truth = source.info().ground_truth;
  KeyframeImages images({.depth_scale = source.camera().depth_scale});
  std::vector<PosedImage> views;
  constexpr int kFrames = 31, kStep = 10;
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    if (i % kStep != 0) continue;
    const auto pose = pose_at(truth, frame->stamp_ns, kNsPerSecond / 10);
    ASSERT_TRUE(pose);
    views.push_back({images.add(frame->color, frame->depth_m), *pose});
  }
  DenseOptions once;
  once.min_observations = 1;
  const auto seen = fuse_keyframes(images, views, source.camera().color, once, 2);
  const auto again = fuse_keyframes(images, views, source.camera().color, {}, 2);
  // A good half of what overlapping views see falls into the same centimetres.
  EXPECT_GT(again.size(), 10000U);
  EXPECT_GT(2.5 * static_cast<double>(again.size()), static_cast<double>(seen.size()));
}

}  // namespace
}  // namespace kinloop
