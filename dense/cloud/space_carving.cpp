#include "dense/cloud/space_carving.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// A free-space violation requires a measured depth beyond the point by this many standard deviations and
/// voxels.
constexpr double kMarginSigmas = 4, kMarginVoxels = 2;

/// All pixels within this distance of a point must agree; pixels this close to the border are not judged.
constexpr int kAroundPx = 2;

/// A block with more points is split, so that they fit into fixed arrays.
constexpr size_t kMaxBlockPoints = 256;

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
    while (end < points.size() && end - begin < kMaxBlockPoints && block_of(points[end].key) == block) ++end;
    const Eigen::Vector3d center = (voxel_of(block).cast<double>().array() + kHalf) * voxel_m;
    blocks.push_back({points.subspan(begin, end - begin), center, radius_m});
    begin = end;
  }
  return blocks;
}

/// Returns whether any part of the block may be visible in the view.
bool in_view(const Block& block, const MeasuredFreeSpace& view, const PinholeCamera& camera) {
  const Eigen::Vector3d p = view.T_camera_world * block.center;
  if (p.z() < -block.radius_m) return false;
  if (p.z() < 2 * block.radius_m) return true;
  // The nearest side of the sphere may project farther out, and so may motion compensation.
  const double margin_px = 2 * block.radius_m * camera.fx / (p.z() - block.radius_m);
  return camera.contains(camera.project(p), -margin_px);
}

/// The largest inverse depth, in steps, around every corner between tiles, row by row: 0 if it is unknown in
/// any of the four tiles. A point within kAroundPx of pixels of these tiles has no others around it.
std::vector<uint16_t> nearest_around_corners(const MeasuredFreeSpace& view, const PinholeCamera& camera) {
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
  return corners;
}

/// Points of a block, and where they lie in a view. All in doubles: mixed types would not be vectorised.
struct BlockPoints {
  size_t count = 0;
  std::array<double, kMaxBlockPoints> x, y, z;        // world, metres
  std::array<double, kMaxBlockPoints> col, row;       // in the view, px
  std::array<double, kMaxBlockPoints> inverse_depth;  // 1/m
  std::array<double, kMaxBlockPoints> in_view;        // 1, or 0: then the others are undefined

  explicit BlockPoints(std::span<const SurfacePoint> points) : count(points.size()) {
    for (size_t i = 0; i < count; ++i) {
      x[i] = static_cast<double>(points[i].p_world.x());
      y[i] = static_cast<double>(points[i].p_world.y());
      z[i] = static_cast<double>(points[i].p_world.z());
    }
  }
};

/// Projects the points of a block into a view: DenseCamera::undo_deskew, written out without branches for the
/// vectoriser, since this runs for every point in every view. `distort(u, v)` takes and returns normalised
/// coordinates.
template <class Distort>
void project_with(const Distort& distort, const MeasuredFreeSpace& view, const DenseCamera& camera,
                  BlockPoints& points) {
  const PinholeCamera& lens = camera.color;
  const double fx = lens.fx, fy = lens.fy, cx = lens.cx, cy = lens.cy;
  const Eigen::Matrix3d R = view.T_camera_world.R();
  const double r00 = R(0, 0), r01 = R(0, 1), r02 = R(0, 2);
  const double r10 = R(1, 0), r11 = R(1, 1), r12 = R(1, 2);
  const double r20 = R(2, 0), r21 = R(2, 1), r22 = R(2, 2);
  const Eigen::Vector3d &t = view.T_camera_world.translation, &v = view.velocity.linear_m_s,
                        &w = view.velocity.angular_rad_s;
  const double tx = t.x(), ty = t.y(), tz = t.z(), vx = v.x(), vy = v.y(), vz = v.z();
  const double wx = w.x(), wy = w.y(), wz = w.z();
  const double last_col = lens.width - 1, last_row = lens.height - 1;
  const double row_time_s = camera.readout_s / lens.height;
  const double first_row_s = view.depth_stamp_difference_s + camera.time_of_row_s(0);
  for (size_t i = 0; i < points.count; ++i) {
    const double x = r00 * points.x[i] + r01 * points.y[i] + r02 * points.z[i] + tx;
    const double y = r10 * points.x[i] + r11 * points.y[i] + r12 * points.z[i] + ty;
    const double z = r20 * points.x[i] + r21 * points.y[i] + r22 * points.z[i] + tz;
    const double time_s = first_row_s + row_time_s * (fy * y / z + cy);
    const double x_then = x - time_s * (vx + wy * z - wz * y);
    const double y_then = y - time_s * (vy + wz * x - wx * z);
    const double z_then = z - time_s * (vz + wx * y - wy * x);
    const double here = 1 / z_then;
    const double u = x_then * here, q = y_then * here;
    const double ideal_col = fx * u + cx, ideal_row = fy * q + cy;
    const auto [distorted_u, distorted_q] = distort(u, q);
    const double col = fx * distorted_u + cx, row = fy * distorted_q + cy;
    points.col[i] = col;
    points.row[i] = row;
    points.inverse_depth[i] = here;
    const bool inside = (z > 0) & (z_then > 0) & (ideal_col >= 0) & (ideal_row >= 0) &
                        (ideal_col <= last_col) & (ideal_row <= last_row) & (col >= kAroundPx) &
                        (row >= kAroundPx) & (col <= last_col - kAroundPx) & (row <= last_row - kAroundPx);
    points.in_view[i] = inside ? 1.0 : 0.0;
  }
}

struct DistortedPoint {
  double u, v;
};

void project(const MeasuredFreeSpace& view, const DenseCamera& camera, BlockPoints& points) {
  const LensDistortion& lens = camera.color.lens;
  if (lens.model != LensModel::kBrownConrady) {
    const auto distort = [&lens](double u, double v) {
      const Eigen::Vector2d d = lens.distort({u, v});
      return DistortedPoint{d.x(), d.y()};
    };
    return project_with(distort, view, camera, points);
  }
  // LensDistortion::distort without branches.
  const auto distort = [k1 = lens.k1, k2 = lens.k2, k3 = lens.k3, p1 = lens.p1, p2 = lens.p2](double u,
                                                                                              double v) {
    const double r2 = u * u + v * v, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return DistortedPoint{u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u),
                          v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v};
  };
  project_with(distort, view, camera, points);
}

/// Counts the contradictions of one view to points projected into it.
void count_contradictions_of(const std::vector<uint16_t>& corners, const DenseCamera& camera,
                             const BlockPoints& projected, const DenseOptions& options,
                             std::span<SurfacePoint> points) {
  constexpr double kTileShare = 1.0 / kTilePx;
  const size_t corners_per_row = static_cast<size_t>(camera.color.width) / kTilePx + 1;
  for (size_t i = 0; i < points.size(); ++i) {
    if (projected.in_view[i] == 0) continue;
    const auto col = static_cast<size_t>((projected.col[i] + kAroundPx) * kTileShare);
    const auto row = static_cast<size_t>((projected.row[i] + kAroundPx) * kTileShare);
    const uint16_t steps = corners[row * corners_per_row + col];
    const double here = projected.inverse_depth[i];
    const double behind = here - steps * kTileStep_per_m;  // of the surface; positive: free space
    const double margin = kMarginSigmas * camera.noise.inverse_sigma_per_m(here) +
                          kMarginVoxels * options.voxel_m * here * here;
    const bool unknown = steps == 0;
    const bool in_sight = unknown | (behind >= -margin);
    const bool free = !unknown & (behind > margin) & options.carve;
    SurfacePoint& point = points[i];
    point.seen_through = point.seen_through || free;
    point.contradictions += static_cast<int>(point.views < options.min_observations ? in_sight : free);
  }
}

}  // namespace

void count_contradictions(std::span<SurfacePoint> points, std::span<const MeasuredFreeSpace> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads) {
  const auto blocks = blocks_of(points, options.voxel_m);
  std::vector<std::vector<uint16_t>> corners;
  for (const MeasuredFreeSpace& view : views) corners.push_back(nearest_around_corners(view, camera.color));
  parallel_for(blocks.size(), threads, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      BlockPoints block_points(blocks[b].points);
      for (size_t i = 0; i < views.size(); ++i) {
        if (!in_view(blocks[b], views[i], camera.color)) continue;
        project(views[i], camera, block_points);
        count_contradictions_of(corners[i], camera, block_points, options, blocks[b].points);
      }
    }
  });
}

}  // namespace kinloop
