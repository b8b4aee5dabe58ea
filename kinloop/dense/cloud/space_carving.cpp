#include "kinloop/dense/cloud/space_carving.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/geometry/depth_noise.hpp"

namespace kinloop {
namespace {

/// A free-space violation requires a measured depth beyond the point by this many standard deviations and
/// voxels.
constexpr double kMarginSigmas = 4, kMarginVoxels = 2;

/// All pixels within this distance of a point must agree; pixels this close to the border are not judged.
constexpr int kAroundPx = 2;

/// Neighbouring points and their bounding sphere.
struct Block {
  std::span<SurfacePoint> points;
  Eigen::Vector3d center;
  double radius_m = 0;
};

std::vector<Block> blocks_of(std::span<SurfacePoint> points, double voxel_m) {
  std::vector<Block> blocks;
  constexpr double kHalf = (1 << kBlockBits) / 2.0;
  const double radius_m = std::sqrt(3.0) * kHalf * voxel_m;
  for (size_t begin = 0; begin < points.size();) {
    size_t end = begin;
    const VoxelKey block = block_of(points[begin].key);
    while (end < points.size() && block_of(points[end].key) == block) ++end;
    const Eigen::Vector3d center = (voxel_of(block).cast<double>().array() + kHalf) * voxel_m;
    blocks.push_back({points.subspan(begin, end - begin), center, radius_m});
    begin = end;
  }
  return blocks;
}

/// Returns whether any part of the block may be visible in the view.
bool in_view(const Block& block, const FreeSpaceView& view, const PinholeCamera& camera) {
  const Eigen::Vector3d p = view.T_camera_world * block.center;
  if (p.z() < -block.radius_m) return false;
  if (p.z() < 2 * block.radius_m) return true;
  // The nearest side of the sphere may project farther out, and so may motion compensation.
  const double margin_px = 2 * block.radius_m * camera.fx / (p.z() - block.radius_m);
  return camera.contains(camera.project(p), -margin_px);
}

/// The largest inverse depth around a pixel; 0 if any is unknown.
double max_inverse_depth_around(const Eigen::Vector2d& pixel, const FreeSpaceView& view,
                                const PinholeCamera& camera) {
  if (!camera.contains(pixel, kAroundPx)) return 0;
  const int cols = camera.width / kTilePx, rows = camera.height / kTilePx;
  const auto tile = [](double px, int around) { return (static_cast<int>(px) + around) / kTilePx; };
  uint16_t nearest = 0;
  for (int r = tile(pixel.y(), -kAroundPx); r <= tile(pixel.y(), kAroundPx); ++r) {
    for (int c = tile(pixel.x(), -kAroundPx); c <= tile(pixel.x(), kAroundPx); ++c) {
      if (r >= rows || c >= cols) return 0;
      const uint16_t here =
          view.nearest[static_cast<size_t>(r) * static_cast<size_t>(cols) + static_cast<size_t>(c)];
      if (here == 0) return 0;
      nearest = std::max(nearest, here);
    }
  }
  return nearest * kTileStep_per_m;
}

/// How a view relates to a point.
enum class Visibility { kNotVisible, kConsistent, kFreeSpace };

Visibility classify_visibility(const Eigen::Vector3f& p_world, const FreeSpaceView& view,
                               const DenseCamera& camera, double voxel_m) {
  const Eigen::Vector3d p_stamp = view.T_camera_world * p_world.cast<double>();
  if (!(p_stamp.z() > 0)) return Visibility::kNotVisible;
  const Eigen::Vector3d p = camera.undo_deskew(p_stamp, view.velocity);
  if (!(p.z() > 0)) return Visibility::kNotVisible;
  const Eigen::Vector2d ideal = camera.color.project(p);
  if (!camera.color.contains(ideal)) return Visibility::kNotVisible;
  const Eigen::Vector2d pixel = camera.color.has_distortion() ? camera.color.distort(ideal) : ideal;
  if (!camera.color.contains(pixel, kAroundPx)) return Visibility::kNotVisible;
  const double nearest = max_inverse_depth_around(pixel, view, camera.color);
  if (!(nearest > 0)) return Visibility::kConsistent;
  const double here = 1 / p.z();
  const double margin =
      kMarginSigmas * DepthNoise().coefficient_per_m + kMarginVoxels * voxel_m * here * here;
  if (nearest - here > margin) return Visibility::kNotVisible;
  return here - nearest > margin ? Visibility::kFreeSpace : Visibility::kConsistent;
}

}  // namespace

void count_free_space_violations(std::span<SurfacePoint> points, std::span<const FreeSpaceView> views,
                                 const DenseCamera& camera, double voxel_m, int threads) {
  const auto blocks = blocks_of(points, voxel_m);
  parallel_for(blocks.size(), threads, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      for (const FreeSpaceView& view : views) {
        if (!in_view(blocks[b], view, camera.color)) continue;
        for (SurfacePoint& point : blocks[b].points) {
          const Visibility visibility = classify_visibility(point.p_world, view, camera, voxel_m);
          point.unoccluded_views += visibility == Visibility::kNotVisible ? 0 : 1;
          point.free_space_violations += visibility == Visibility::kFreeSpace ? 1 : 0;
        }
      }
    }
  });
}

}  // namespace kinloop
