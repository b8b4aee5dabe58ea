#include "dense/surfels/surface_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// Noise spreads a surface over this many standard deviations in either direction.
constexpr float kSpreadSigmas = 2;

/// A voxel whose weight is below this share of another's on the same surface is only noise.
constexpr float kMinWeightRatio = 0.5F;

/// Key of the voxel that contains the point.
VoxelKey key_at(const Eigen::Vector3d& p_voxels) {
  return voxel_key(Eigen::Vector3d(p_voxels.array().floor()));
}

/// The voxels along a surface normal over which noise may have spread the surface.
class Column {
 public:
  void add(const Voxel& voxel) {
    const auto weight = static_cast<double>(voxel.weight);
    sum_ += weight * voxel_of(voxel.key).cast<double>() + voxel.offset_sum.cast<double>();
    weight_ += weight;
    surest_ = std::max(surest_, voxel.weight);
    // Two voxels with one view each have two views in total unless the view is the same.
    const bool another = views_ > 0 && voxel.last_view != last_view_;
    views_ = std::max<int>({views_, voxel.views, another ? 2 : 1});
    last_view_ = voxel.last_view;
  }

  [[nodiscard]] Eigen::Vector3d mean_voxels() const { return sum_ / weight_; }
  [[nodiscard]] float surest() const { return surest_; }
  [[nodiscard]] int views() const { return views_; }

 private:
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();  // of points, voxels
  double weight_ = 0;
  float surest_ = 0;
  int views_ = 0;
  uint16_t last_view_ = 0;
};

Column column_through(const Voxel& voxel, const VoxelShards& grids, double voxel_m) {
  Column column;
  column.add(voxel);
  const Eigen::Vector3f normal = voxel.normal_sum.normalized();
  if (!normal.allFinite()) return column;
  const float sigma_m = std::sqrt(voxel.pixels / voxel.weight);
  const auto reach = static_cast<int>(
      std::min(kSpreadSigmas * sigma_m / static_cast<float>(voxel_m), static_cast<float>(kMaxSpreadVoxels)));
  const Eigen::Vector3d start =
      voxel_of(voxel.key).cast<double>() + (voxel.offset_sum / voxel.weight).cast<double>();
  for (int step = -reach; step <= reach; ++step) {
    const VoxelKey key = key_at(start + step * normal.cast<double>());
    if (key == voxel.key) continue;
    const Voxel* found = grids[shard_of(key)].find(key);
    if (found != nullptr) column.add(*found);
  }
  return column;
}

/// Returns the surface point of a voxel; nullopt if the voxel is noise.
std::optional<SurfacePoint> point_of(const Voxel& voxel, const VoxelShards& grids,
                                     const DenseOptions& options) {
  const Column column = column_through(voxel, grids, options.voxel_m);
  if (voxel.weight < kMinWeightRatio * column.surest()) return std::nullopt;
  const Eigen::Vector3d mean = column.mean_voxels();
  SurfacePoint point;
  point.key = key_at(mean);
  point.p_world = (mean * options.voxel_m).cast<float>();
  point.normal = voxel.normal_sum.normalized();
  point.color = mean_color(voxel);
  point.views = column.views();
  point.weight = voxel.weight;
  point.origin = voxel.key;
  return point;
}

/// Orders by block, then voxel; within a voxel, points with enough observations first, then by weight.
bool precedes(const SurfacePoint& a, const SurfacePoint& b, int enough) {
  return std::tuple(block_of(a.key), a.key, a.views < enough, -a.weight, a.origin) <
         std::tuple(block_of(b.key), b.key, b.views < enough, -b.weight, b.origin);
}

}  // namespace

std::vector<SurfacePoint> surface_points(VoxelShards grids, const Slab& slab, const DenseOptions& options,
                                         int threads) {
  std::array<std::vector<SurfacePoint>, kShards> parts;
  parallel_for(kShards, threads, [&](size_t begin, size_t end) {
    for (size_t grid = begin; grid < end; ++grid) {
      for (const Voxel& voxel : grids[grid].voxels()) {
        const auto point = point_of(voxel, grids, options);
        if (point && slab.contains(point->key)) parts[grid].push_back(*point);
      }
    }
  });
  grids = {};  // frees memory for the next step
  size_t count = 0;
  for (const auto& part : parts) count += part.size();
  std::vector<SurfacePoint> points;
  points.reserve(count);
  for (auto& part : parts) {
    points.insert(points.end(), part.begin(), part.end());
    part = std::vector<SurfacePoint>();  // frees its memory, unlike {}
  }
  std::sort(points.begin(), points.end(), [&](const SurfacePoint& a, const SurfacePoint& b) {
    return precedes(a, b, options.min_observations);
  });
  const auto same_voxel = [](const SurfacePoint& a, const SurfacePoint& b) { return a.key == b.key; };
  points.erase(std::unique(points.begin(), points.end(), same_voxel), points.end());
  return points;
}

}  // namespace kinloop
