#include "kinloop/dense/fuse_patches.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/quantile.hpp"
#include "kinloop/dense/carve.hpp"
#include "kinloop/dense/surface_points.hpp"

namespace kinloop {
namespace {

constexpr int kFirstSlice = -static_cast<int>(kVoxelOrigin);
constexpr int kLastSlice = static_cast<int>(kVoxelOrigin);

/// The samples of one view, by grid.
using DealtSamples = std::array<std::vector<VoxelSample>, kGrids>;

size_t voxel_count(const VoxelGrids& grids) {
  size_t count = 0;
  for (const VoxelGrid& grid : grids) count += grid.voxels().size();
  return count;
}

/// The slice of every voxel.
std::vector<int> slices_of(const VoxelGrids& grids) {
  std::vector<int> slices;
  for (const VoxelGrid& grid : grids) {
    for (const Voxel& voxel : grid.voxels()) slices.push_back(voxel_of(voxel.key).z());
  }
  return slices;
}

class Fusion {
 public:
  Fusion(const PatchGiver& patch_of, std::span<const PosedImage> views, const DenseCamera& camera,
         const DenseOptions& options, int threads, const Progress& progress)
      : patch_of_(patch_of),
        views_(views),
        camera_(camera),
        options_(options),
        threads_(threads),
        progress_(progress),
        rays_(ray_table(camera.color)) {}

  ColoredCloud run() {
    ColoredCloud cloud;
    for (int begin = kFirstSlice; begin < kLastSlice && !stopped_;) {
      Slab slab{begin, kLastSlice};
      auto points = fill(slab);
      look_again(points);
      for (const SurfacePoint& point : points) {
        if (!stays(point)) continue;
        cloud.points.push_back(point.p_world);
        cloud.colors.push_back(point.color);
        cloud.normals.push_back(point.normal);
      }
      begin = slab.end;
    }
    return cloud;
  }

 private:
  /// The points of the slab, whose end comes nearer when there is not enough memory for all of it.
  std::vector<SurfacePoint> fill(Slab& slab) {
    VoxelGrids grids;
    for_each_batch("fusing", [&](size_t first, const std::vector<DepthPatch>& patches) {
      std::vector<DealtSamples> dealt(patches.size());
      parallel_for(patches.size(), threads_, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) dealt[i] = deal(patches[i], views_[first + i], slab);
      });
      parallel_for(kGrids, threads_, [&](size_t begin, size_t end) {
        for (size_t grid = begin; grid < end; ++grid) {
          for (size_t i = 0; i < dealt.size(); ++i) {
            for (const VoxelSample& sample : dealt[i][grid]) {
              grids[grid].add(sample, static_cast<uint32_t>(first + i));
            }
          }
        }
      });
      make_fit(grids, slab);
    });
    return surface_points(std::move(grids), slab, options_, threads_);
  }

  [[nodiscard]] DealtSamples deal(const DepthPatch& patch, const PosedImage& view, const Slab& slab) const {
    DealtSamples dealt;
    for (auto& part : dealt) part.reserve(patch.points.size() / kGrids * 5 / 4);
    for (const VoxelSample& sample : voxel_samples(patch, view, camera_, rays_, options_.voxel_m)) {
      if (slab.contains(sample.key, kHaloSlices)) dealt[grid_of(sample.key)].push_back(sample);
    }
    return dealt;
  }

  /// Puts the farther half off to a later slab while there are too many voxels.
  void make_fit(VoxelGrids& grids, Slab& slab) const {
    // Beside the voxel itself: its place in the table, room to grow, the point that is made of it.
    constexpr size_t kBytesPerVoxel = 4 * sizeof(Voxel);
    const size_t most = (static_cast<size_t>(options_.fusion_memory_mib) << 20) / kBytesPerVoxel;
    while (voxel_count(grids) > most) {
      // Whole blocks, so that the order of points does not depend on where a slab ends.
      constexpr int kBlock = 1 << kBlockBits;
      const int end = std::max(median(slices_of(grids)), slab.begin + kBlock) & ~(kBlock - 1);
      if (end <= slab.begin || end >= slab.end) return;
      slab.end = end;
      for (VoxelGrid& grid : grids) grid.drop_from(voxel_key(kFirstSlice, kFirstSlice, end + kHaloSlices));
    }
  }

  /// What few images looked at cannot have been seen by many.
  [[nodiscard]] bool stays(const SurfacePoint& point) const {
    if (options_.carve && point.seen_through > point.views) return false;
    return point.views >= std::min(options_.min_observations, std::max(point.looked, 1));
  }

  void look_again(std::vector<SurfacePoint>& points) {
    for_each_batch("carving", [&](size_t first, const std::vector<DepthPatch>& patches) {
      std::vector<FreeSpace> free;
      for (size_t i = 0; i < patches.size(); ++i) {
        const PosedImage& view = views_[first + i];
        free.push_back({view.T_world_camera.inverse(), view.velocity, patches[i].nearest});
      }
      count_looks(points, free, camera_, options_.voxel_m, threads_);
    });
  }

  template <class Use>
  void for_each_batch(const char* what, const Use& use) {
    const auto batch_size = static_cast<size_t>(std::max(threads_, 1));
    for (size_t first = 0; first < views_.size(); first += batch_size) {
      if (!report(progress_, what, first, views_.size())) {
        stopped_ = true;
        return;
      }
      std::vector<DepthPatch> patches(std::min(batch_size, views_.size() - first));
      parallel_for(patches.size(), threads_, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) patches[i] = patch_of_(views_[first + i].image);
      });
      use(first, patches);
    }
    report(progress_, what, views_.size(), views_.size());
  }

  const PatchGiver& patch_of_;
  std::span<const PosedImage> views_;
  const DenseCamera& camera_;
  const DenseOptions& options_;
  int threads_;
  const Progress& progress_;
  RayTable rays_;
  bool stopped_ = false;
};

}  // namespace

ColoredCloud fuse_patches(const PatchGiver& patch_of, std::span<const PosedImage> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads,
                          const Progress& progress) {
  return Fusion(patch_of, views, camera, options, threads, progress).run();
}

}  // namespace kinloop
