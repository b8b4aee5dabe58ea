#include "kinloop/dense/cloud/space_carving.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// Index of a corner between tiles where no point is looked up; marks points outside the view.
constexpr int kOutOfView = 0;

/// The largest inverse depth, in steps, around every corner between tiles, row by row: 0 if it is unknown in
/// any of the four tiles. A point within kAroundPx of pixels of these tiles has no others around it.
std::vector<uint16_t> nearest_around_corners(const FreeSpaceView& view, const PinholeCamera& camera) {
  static_assert(kTilePx == 2 * kAroundPx);
  const size_t cols = static_cast<size_t>(camera.width) / kTilePx;
  const size_t rows = static_cast<size_t>(camera.height) / kTilePx;
  std::vector<uint16_t> corners((rows + 1) * (cols + 1), 0);
  for (size_t row = 1; row < rows; ++row) {
    const uint16_t* above = &view.nearest[(row - 1) * cols];
    const uint16_t* below = &view.nearest[row * cols];
    for (size_t col = 1; col < cols; ++col) {
      const auto [least, most] = std::minmax({above[col - 1], above[col], below[col - 1], below[col]});
      corners[row * (cols + 1) + col] = least == 0 ? uint16_t{0} : most;
    }
  }
  corners[kOutOfView] = std::numeric_limits<uint16_t>::max();  // nearer than any point: occluded
  return corners;
}

/// Points of a block as arrays, and where they lie in a view.
struct BlockPoints {
  std::vector<double> x, y, z;        // world, metres
  std::vector<double> inverse_depth;  // in the view, 1/m; 0 = out of view
  std::vector<int32_t> corner;        // nearest corner between tiles; kOutOfView = out of view

  void assign(std::span<const SurfacePoint> points) {
    for (auto* values : {&x, &y, &z, &inverse_depth}) values->resize(points.size());
    corner.resize(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      x[i] = static_cast<double>(points[i].p_world.x());
      y[i] = static_cast<double>(points[i].p_world.y());
      z[i] = static_cast<double>(points[i].p_world.z());
    }
  }
};

/// Projects the points of a block into a view: DenseCamera::undo_deskew and PinholeCamera::distort, written
/// out without branches, since this runs for every point in every view.
void project(const FreeSpaceView& view, const DenseCamera& camera, BlockPoints& points) {
  const PinholeCamera& lens = camera.color;
  const Eigen::Matrix3d R = view.T_camera_world.R();
  const Eigen::Vector3d t = view.T_camera_world.translation;
  const Eigen::Vector3d v = view.velocity.linear_m_s, w = view.velocity.angular_rad_s;
  const double last_col = lens.width - 1, last_row = lens.height - 1;
  const double row_time_s = camera.readout_s / lens.height, first_row_s = camera.time_of_row_s(0);
  const int corners_per_row = lens.width / kTilePx + 1;
  constexpr double kTileShare = 1.0 / kTilePx;
  const size_t count = points.x.size();
  const double *xs = points.x.data(), *ys = points.y.data(), *zs = points.z.data();
  double* inverse_depths = points.inverse_depth.data();
  int32_t* corners = points.corner.data();
  for (size_t i = 0; i < count; ++i) {
    const double x = R(0, 0) * xs[i] + R(0, 1) * ys[i] + R(0, 2) * zs[i] + t.x();
    const double y = R(1, 0) * xs[i] + R(1, 1) * ys[i] + R(1, 2) * zs[i] + t.y();
    const double z = R(2, 0) * xs[i] + R(2, 1) * ys[i] + R(2, 2) * zs[i] + t.z();
    const double time_s = first_row_s + row_time_s * (lens.fy * y / z + lens.cy);
    const double x_then = x - time_s * (v.x() + w.y() * z - w.z() * y);
    const double y_then = y - time_s * (v.y() + w.z() * x - w.x() * z);
    const double z_then = z - time_s * (v.z() + w.x() * y - w.y() * x);
    const double here = 1 / z_then;
    const double u = x_then * here, q = y_then * here, r2 = u * u + q * q;
    const double ideal_col = lens.fx * u + lens.cx, ideal_row = lens.fy * q + lens.cy;
    const double radial = 1 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
    const double col = lens.fx * (u * radial + 2 * lens.p1 * u * q + lens.p2 * (r2 + 2 * u * u)) + lens.cx;
    const double row = lens.fy * (q * radial + lens.p1 * (r2 + 2 * q * q) + 2 * lens.p2 * u * q) + lens.cy;
    const bool seen = (z > 0) & (z_then > 0) & (ideal_col >= 0) & (ideal_row >= 0) & (ideal_col <= last_col) &
                      (ideal_row <= last_row) & (col >= kAroundPx) & (row >= kAroundPx) &
                      (col <= last_col - kAroundPx) & (row <= last_row - kAroundPx);
    const auto tile_col = static_cast<int32_t>((seen ? col + kAroundPx : 0) * kTileShare);
    const auto tile_row = static_cast<int32_t>((seen ? row + kAroundPx : 0) * kTileShare);
    inverse_depths[i] = seen ? here : 0;
    corners[i] = tile_row * corners_per_row + tile_col;
  }
}

/// Counts the contradictions of one view to points projected into it.
class Judge {
 public:
  explicit Judge(const DenseOptions& options)
      : margin_voxels_m_(kMarginVoxels * options.voxel_m),
        min_observations_(options.min_observations),
        carve_(options.carve) {}

  void count(const BlockPoints& projected, const std::vector<uint16_t>& corners,
             std::span<SurfacePoint> points) const {
    for (size_t i = 0; i < points.size(); ++i) {
      SurfacePoint& point = points[i];
      const uint16_t steps = corners[static_cast<size_t>(projected.corner[i])];
      const double here = projected.inverse_depth[i];
      const double behind = here - steps * kTileStep_per_m;  // the surface behind the point
      const double margin = kMarginSigmas * DepthNoise().coefficient_per_m + margin_voxels_m_ * here * here;
      const bool unknown = steps == 0;
      const bool in_sight = unknown | (behind >= -margin);
      const bool free = !unknown & (behind > margin) & carve_;
      point.contradictions += static_cast<int>(point.views < min_observations_ ? in_sight : free);
    }
  }

 private:
  double margin_voxels_m_;
  int min_observations_;
  bool carve_;
};

}  // namespace

void count_contradictions(std::span<SurfacePoint> points, std::span<const FreeSpaceView> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads) {
  const auto blocks = blocks_of(points, options.voxel_m);
  std::vector<std::vector<uint16_t>> corners;
  for (const FreeSpaceView& view : views) corners.push_back(nearest_around_corners(view, camera.color));
  const Judge judge(options);
  parallel_for(blocks.size(), threads, [&](size_t begin, size_t end) {
    BlockPoints block_points;
    for (size_t b = begin; b < end; ++b) {
      block_points.assign(blocks[b].points);
      for (size_t i = 0; i < views.size(); ++i) {
        if (!in_view(blocks[b], views[i], camera.color)) continue;
        project(views[i], camera, block_points);
        judge.count(block_points, corners[i], blocks[b].points);
      }
    }
  });
}

}  // namespace kinloop
