#pragma once
// In: the surfels of one image and its pose. Out: one sample per surfel with its voxel.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dense/posed_image.hpp"
#include "dense/surfels/image_surfels.hpp"

namespace kinloop {

/// Voxel coordinates packed as 21 bits per axis, z highest, offset by kVoxelOrigin.
using VoxelKey = uint64_t;
constexpr int kVoxelAxisBits = 21;
constexpr int64_t kVoxelOrigin = int64_t{1} << (kVoxelAxisBits - 1);

/// Returns the key of integer voxel coordinates, each from -kVoxelOrigin to kVoxelOrigin - 1.
constexpr VoxelKey voxel_key(int64_t x, int64_t y, int64_t z) {
  const auto part = [](int64_t v) { return static_cast<VoxelKey>(v + kVoxelOrigin); };
  return part(z) << (2 * kVoxelAxisBits) | part(y) << kVoxelAxisBits | part(x);
}

/// Same for the corner of a voxel, given as integer-valued doubles.
inline VoxelKey voxel_key(const Eigen::Vector3d& corner) {
  return voxel_key(static_cast<int64_t>(corner.x()), static_cast<int64_t>(corner.y()),
                   static_cast<int64_t>(corner.z()));
}

/// Key of the first voxel of the aligned cube with an edge of 2^`bits` voxels that contains a voxel.
constexpr VoxelKey aligned_key(VoxelKey key, int bits) {
  const VoxelKey axis = ((VoxelKey{1} << kVoxelAxisBits) - 1) >> bits << bits;
  return key & (axis | axis << kVoxelAxisBits | axis << (2 * kVoxelAxisBits));
}

/// Returns the voxel coordinates of a key.
Eigen::Vector3i voxel_of(VoxelKey key);

/// Hashes keys evenly over 64 bits; the highest bits are mixed best.
constexpr uint64_t hash_key(VoxelKey key) {
  constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio (Knuth, TAOCP 6.4)
  return (key ^ key >> 29) * kGolden;
}

/// A surfel in the world frame.
struct VoxelSample {
  VoxelKey key = 0;
  Eigen::Vector3f offset;  ///< from the voxel's corner, in voxels
  Eigen::Vector3f normal;  ///< towards the camera
  float pixels = 0;        ///< of the surfel
  float variance_m2 = 0;   ///< of one pixel's depth, along the ray
  float color_weight = 0;  ///< quality of the colour: sharp, close, frontal
  Rgb color{};
};

/// Viewing ray (x / z, y / z) of every pixel of the raw (distorted) image.
struct RayTable {
  int width = 0, height = 0;  // px
  double focal_px = 0;
  std::vector<Eigen::Vector2f> rays;  // row by row
};

RayTable ray_table(const PinholeCamera& camera, int threads = 1);

/// Transforms `surfels` to the world frame, motion-compensated to the stamp of `view`. `rays` must be those
/// of `camera.color`.
std::vector<VoxelSample> voxel_samples(const ImageSurfels& surfels, const PosedImage& view,
                                       const DenseCamera& camera, const RayTable& rays, double voxel_m);

}  // namespace kinloop
