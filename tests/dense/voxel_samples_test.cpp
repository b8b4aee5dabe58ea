#include "kinloop/dense/voxel_samples.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "kinloop/dense/voxel_grid.hpp"
#include "tests/dense/plane_view.hpp"

namespace kinloop {
namespace {

using test::small_camera;
using test::view_of_wall;

const cv::Vec3b kBgr(10, 120, 250);

/// Mean points of all voxels that one image sees.
std::vector<Voxel> voxels_of(const RgbdImages& images, const PinholeCamera& camera, const SE3& T_world_camera,
                             const DenseOptions& options) {
  VoxelGrid grid;
  for (const auto& sample :
       voxel_samples(images.color, images.depth_m, T_world_camera, ray_table(camera), options)) {
    grid.add(sample, 0);
  }
  return grid.voxels();
}

size_t pixel_count(const std::vector<Voxel>& voxels) {
  size_t count = 0;
  for (const auto& voxel : voxels) count += voxel.pixels;
  return count;
}

TEST(VoxelSamples, OfAWallLieOnTheWallWhateverTheLens) {
  const SE3 T_world_camera{exp_so3({0.2, -0.3, 0.5}), {4, -2, 1}};
  for (const auto& camera : {small_camera(), test::distorted_camera()}) {
    const auto voxels =
        voxels_of(view_of_wall(camera, T_world_camera, 2.503, kBgr), camera, T_world_camera, {});
    ASSERT_GT(voxels.size(), 1000U);
    for (const auto& voxel : voxels) {
      EXPECT_NEAR(mean_point(voxel, 0.01).z(), 2.503, 1e-4);
      EXPECT_EQ(mean_color(voxel), (Rgb{250, 120, 10}));
    }
  }
}

TEST(VoxelSamples, EveryPixelInsideTheBorderCountsOnce) {
  const auto images = view_of_wall(small_camera(), {}, 1.5, kBgr);
  EXPECT_EQ(pixel_count(voxels_of(images, small_camera(), {}, {})), 156U * 116U);
  DenseOptions sparse;
  sparse.stride_px = 4;
  EXPECT_EQ(pixel_count(voxels_of(images, small_camera(), {}, sparse)), 39U * 29U);
}

TEST(VoxelSamples, OutsideTheRangeThereIsNothing) {
  EXPECT_TRUE(voxels_of(view_of_wall(small_camera(), {}, 0.2, kBgr), small_camera(), {}, {}).empty());
  EXPECT_TRUE(voxels_of(view_of_wall(small_camera(), {}, 9, kBgr), small_camera(), {}, {}).empty());
  auto images = view_of_wall(small_camera(), {}, 1, kBgr);
  images.depth_m.setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(voxels_of(images, small_camera(), {}, {}).empty());
  const SE3 nowhere{Eigen::Quaterniond::Identity(), {1e9, 0, 0}};
  EXPECT_TRUE(voxels_of(view_of_wall(small_camera(), {}, 1, kBgr), small_camera(), nowhere, {}).empty());
}

TEST(VoxelSamples, FlyingPixelsBetweenTwoSurfacesAreLeftOut) {
  auto images = view_of_wall(small_camera(), {}, 3, kBgr);
  images.depth_m.colRange(0, 80).setTo(1.0F);
  images.depth_m.col(80).setTo(2.0F);  // neither here nor there
  for (const auto& voxel : voxels_of(images, small_camera(), {}, {})) {
    const float z = mean_point(voxel, 0.01).z();
    EXPECT_TRUE(std::abs(z - 1) < 0.01F || std::abs(z - 3) < 0.01F) << z;
  }
}

TEST(VoxelSamples, SurfacesSeenAtAGrazingAngleAreLeftOut) {
  for (const auto& [angle_deg, seen] : {std::pair(60.0, true), std::pair(87.0, false)}) {
    const double angle_rad = angle_deg * M_PI / 180;
    // A wall through (0, 0, 1.5) m that is turned about the image's columns.
    cv::Mat depth_m(120, 160, CV_32FC1);
    for (int col = 0; col < 160; ++col) {
      const double x = (col - 79.5) / 130;
      depth_m.col(col).setTo(static_cast<float>(1.5 / (1 - x * std::tan(angle_rad))));
    }
    const RgbdImages images{cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(9)), depth_m};
    size_t middle = 0;
    for (const auto& voxel : voxels_of(images, small_camera(), {}, {})) {
      const auto p = mean_point(voxel, 0.01);
      if (std::abs(p.x()) < 0.02F) middle += voxel.pixels;
    }
    EXPECT_EQ(middle > 0, seen) << angle_deg << " degrees";
  }
}

TEST(VoxelSamples, HolesBesideASurfaceDoNotMakeItAnEdge) {
  auto images = view_of_wall(small_camera(), {}, 1.5, kBgr);
  images.depth_m.colRange(70, 90).setTo(0.0F);
  EXPECT_EQ(pixel_count(voxels_of(images, small_camera(), {}, {})), (156U - 20U) * 116U);
}

}  // namespace
}  // namespace kinloop
