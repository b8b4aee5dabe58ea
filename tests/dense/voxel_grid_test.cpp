#include "dense/surfels/voxel_grid.hpp"

#include <map>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/dense/plane_view.hpp"

namespace kinloop {
namespace {

VoxelSample sample_of(VoxelKey key, float pixels) {
  return {key, {0.25F, 0.5F, 0.75F}, {0, 0, -1}, pixels, 1e-4F, 1, {10, 20, 30}};
}

TEST(VoxelSamples, OfAWallLieOnTheWallWhateverTheLens) {
  const SE3 T_world_camera{exp_so3({0.2, -0.3, 0.5}), {4, -2, 1}};
  for (const auto& lens : {test::small_camera(), test::distorted_camera()}) {
    const auto surfels =
        extract_surfels(test::view_of_wall(lens, T_world_camera, 2.503, {10, 120, 250}), {lens.fx}, {});
    VoxelGrid grid;
    for (const auto& sample :
         voxel_samples(surfels, {0, T_world_camera}, {.color = lens}, ray_table(lens), 0.01)) {
      grid.add(sample, 0);
      EXPECT_GT(-sample.normal.z(), 0.99F);
    }
    ASSERT_GT(grid.voxels().size(), 1000U);
    for (const auto& voxel : grid.voxels()) {
      EXPECT_NEAR(mean_point(voxel, 0.01).z(), 2.503, 5e-4);
      EXPECT_EQ(mean_color(voxel), (Rgb{250, 120, 10}));
    }
  }
}

TEST(VoxelSamples, FarOutOfTheWorldThereIsNothing) {
  const auto camera = test::small_camera();
  const auto surfels = extract_surfels(test::view_of_wall(camera, {}, 1, {}), {camera.fx}, {});
  const SE3 nowhere{Eigen::Quaterniond::Identity(), {1e9, 0, 0}};
  EXPECT_TRUE(voxel_samples(surfels, {0, nowhere}, {.color = camera}, ray_table(camera), 0.01).empty());
}

TEST(VoxelGrid, KeysAreOfTheirVoxels) {
  for (const Eigen::Vector3i& voxel : {Eigen::Vector3i(0, 0, 0), {-5, 7, 1 << 19}, {-(1 << 20), -1, 3}}) {
    EXPECT_EQ(voxel_of(voxel_key(voxel.x(), voxel.y(), voxel.z())), voxel);
  }
}

TEST(VoxelGrid, FindsEveryKeyAgain) {
  VoxelGrid grid;
  EXPECT_EQ(grid.find(7), nullptr);
  Random random(3);
  std::map<VoxelKey, float> expected;
  for (uint32_t i = 0; i < 50000; ++i) {
    const uint32_t z = random.index(100), x = random.index(200);
    const VoxelKey key = voxel_key(x, 0, z);
    const auto pixels = static_cast<float>(1 + random.index(3));
    grid.add(sample_of(key, pixels), i);
    expected[key] += pixels;
  }
  ASSERT_EQ(grid.voxels().size(), expected.size());
  for (const auto& [key, pixels] : expected) EXPECT_EQ(grid.find(key)->pixels, pixels);
  grid.erase_from(voxel_key(0, 0, 50));
  for (const auto& [key, pixels] : expected) EXPECT_EQ(grid.find(key) != nullptr, voxel_of(key).z() < 50);
}

TEST(VoxelGrid, AddingManySamplesIsAddingEach) {
  Random random(8);
  std::vector<VoxelSample> samples;
  for (int i = 0; i < 20'000; ++i) {
    const uint32_t z = random.index(9), y = random.index(40), x = random.index(40);
    const VoxelKey key = voxel_key(x - 20, y - 20, z);
    samples.push_back(sample_of(key, static_cast<float>(1 + random.index(5))));
  }
  std::vector<uint32_t> every_third;
  for (uint32_t i = 0; i < samples.size(); i += 3) every_third.push_back(i);
  VoxelGrid many, each;
  for (uint32_t view = 0; view < 3; ++view) {
    many.add(samples, every_third, view);
    for (const uint32_t i : every_third) each.add(samples[i], view);
  }
  ASSERT_EQ(many.voxels().size(), each.voxels().size());
  for (size_t i = 0; i < many.voxels().size(); ++i) {
    EXPECT_EQ(many.voxels()[i].key, each.voxels()[i].key);
    EXPECT_EQ(many.voxels()[i].weight, each.voxels()[i].weight);
    EXPECT_EQ(many.voxels()[i].color, each.voxels()[i].color);
    EXPECT_EQ(many.voxels()[i].views, each.voxels()[i].views);
  }
}

TEST(VoxelGrid, MeansOutliveManyViews) {
  VoxelGrid grid;
  const VoxelKey key = voxel_key(1, 2, 3);
  for (uint32_t view = 0; view < 100000; ++view) grid.add(sample_of(key, 16), view);
  EXPECT_EQ(mean_color(grid.voxels()[0]), (Rgb{10, 20, 30}));
  EXPECT_EQ(grid.voxels()[0].views, 65535);
  EXPECT_LT((mean_point(grid.voxels()[0], 1) - Eigen::Vector3f(1.25F, 2.5F, 3.75F)).norm(), 0.01F);
}

}  // namespace
}  // namespace kinloop
