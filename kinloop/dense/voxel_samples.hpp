#pragma once
// In: one posed depth image with colours. Out: what it says about the voxels that it sees, in integers, so
// that sums of it are exact.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/dense/options.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Which voxel a point lies in: 21 bits an axis, z highest, counted from kVoxelOrigin below the origin.
using VoxelKey = uint64_t;
constexpr int kVoxelAxisBits = 21;
constexpr int64_t kVoxelOrigin = int64_t{1} << (kVoxelAxisBits - 1);

/// Steps into which a voxel's edge is divided for the mean position.
constexpr int kVoxelSteps = 256;

/// Pixels that fall into one voxel.
struct VoxelSample {
  VoxelKey key = 0;
  uint32_t pixels = 0;
  std::array<uint32_t, 3> steps{};   ///< sums of positions within the voxel
  std::array<uint32_t, 3> colors{};  ///< sums of red, green, blue
};

/// Scatters keys evenly over 64 bits; the highest bits are scattered best.
constexpr uint64_t scatter(VoxelKey key) {
  constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio (Knuth, TAOCP 6.4)
  return (key ^ key >> 29) * kGolden;
}

/// For every pixel of the raw (distorted) image the direction in which it looks, as (x / z, y / z).
struct RayTable {
  int width = 0, height = 0;  // px
  double focal_px = 0;
  std::vector<Eigen::Vector2f> rays;  // row by row
};

RayTable ray_table(const PinholeCamera& camera);

/// The samples of an image; a voxel may have several. Pixels at depth edges, on surfaces seen at a grazing
/// angle and outside the range are left out. `color` is 8UC3 BGR, `depth_m` 32FC1, both of the size of
/// `rays`.
std::vector<VoxelSample> voxel_samples(const cv::Mat& color, const cv::Mat& depth_m,
                                       const SE3& T_world_camera, const RayTable& rays,
                                       const DenseOptions& options);

}  // namespace kinloop
