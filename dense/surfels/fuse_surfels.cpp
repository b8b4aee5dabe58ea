#include "dense/surfels/fuse_surfels.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "dense/cloud/space_carving.hpp"
#include "dense/surfels/surface_points.hpp"
#include "dense/surfels/voxel_grid.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

constexpr int kFirstSlice = -static_cast<int>(kVoxelOrigin);
constexpr int kLastSlice = static_cast<int>(kVoxelOrigin);

/// The samples of one view.
struct BinnedSamples {
  std::vector<VoxelSample> samples;
  std::array<std::vector<uint32_t>, kShards> of_shard;  // their indices, by shard
};

size_t voxel_count(const VoxelShards& grids) {
  size_t count = 0;
  for (const VoxelGrid& grid : grids) count += grid.voxels().size();
  return count;
}

/// The z slice of every voxel.
std::vector<int> slices_of(const VoxelShards& grids) {
  std::vector<int> slices;
  for (const VoxelGrid& grid : grids) {
    for (const Voxel& voxel : grid.voxels()) slices.push_back(voxel_of(voxel.key).z());
  }
  return slices;
}

class Fusion {
 public:
  Fusion(const SurfelLoader& load_surfels, std::span<const PosedImage> views, const DenseCamera& camera,
         const DenseOptions& options, int threads, const Progress& progress)
      : load_surfels_(load_surfels),
        views_(views),
        camera_(camera),
        options_(options),
        threads_(threads),
        progress_(progress),
        rays_(ray_table(camera.color, threads)) {}

  ColoredCloud run() {
    ColoredCloud cloud;
    for (int begin = kFirstSlice; begin < kLastSlice && !stopped_;) {
      Slab slab{begin, kLastSlice};
      auto points = fill(slab);
      carve(points);
      add(points, cloud);
      begin = slab.end;
    }
    if (options_.carve) remove_remnants(cloud);
    return cloud;
  }

 private:
  /// Returns the points of the slab, whose end is lowered if memory does not suffice for all of it.
  std::vector<SurfacePoint> fill(Slab& slab) {
    VoxelShards grids;
    for_each_batch("fusing", [&](size_t first, std::vector<ImageSurfels>& batch) {
      std::vector<BinnedSamples> binned(batch.size());
      parallel_for(batch.size(), threads_, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) binned[i] = bin_samples(batch[i], views_[first + i], slab);
      });
      parallel_for(kShards, threads_, [&](size_t begin, size_t end) {
        for (size_t grid = begin; grid < end; ++grid) {
          for (size_t i = 0; i < binned.size(); ++i) {
            grids[grid].add(binned[i].samples, binned[i].of_shard[grid], static_cast<uint32_t>(first + i));
          }
        }
      });
      shrink_to_budget(grids, slab);
    });
    return surface_points(std::move(grids), slab, options_, threads_);
  }

  [[nodiscard]] BinnedSamples bin_samples(const ImageSurfels& surfels, const PosedImage& view,
                                          const Slab& slab) const {
    BinnedSamples binned{voxel_samples(surfels, view, camera_, rays_, options_.voxel_m), {}};
    for (auto& part : binned.of_shard) part.reserve(surfels.points.size() / kShards * 5 / 4);
    for (uint32_t i = 0; i < binned.samples.size(); ++i) {
      const VoxelKey key = binned.samples[i].key;
      if (slab.contains(key, kHaloSlices)) binned.of_shard[shard_of(key)].push_back(i);
    }
    return binned;
  }

  /// Defers the farther half to a later slab while there are too many voxels.
  void shrink_to_budget(VoxelShards& grids, Slab& slab) const {
    // The voxel itself, its table entry, spare capacity and the point made from it.
    constexpr size_t kBytesPerVoxel = 4 * sizeof(Voxel);
    const size_t most = (static_cast<size_t>(options_.fusion_memory_mib) << 20) / kBytesPerVoxel;
    while (voxel_count(grids) > most) {
      // Whole blocks, so that the order of points does not depend on slab boundaries.
      constexpr int kBlock = 1 << kBlockBits;
      const int end = std::max(median(slices_of(grids)), slab.begin + kBlock) & ~(kBlock - 1);
      if (end <= slab.begin || end >= slab.end) return;
      slab.end = end;
      for (VoxelGrid& grid : grids) grid.erase_from(voxel_key(kFirstSlice, kFirstSlice, end + kHaloSlices));
    }
  }

  /// Removes the points that more views contradict than observed. A place that few images could see cannot
  /// have been observed by many.
  void carve(std::vector<SurfacePoint>& points) {
    // Several views at a time, since every pass goes over all points.
    constexpr size_t kViews = 32;
    std::vector<MeasuredFreeSpace> views;
    const auto flush = [&] {
      count_contradictions(points, views, camera_, options_, threads_);
      std::erase_if(points, [this](const SurfacePoint& point) {
        const bool carved = point.contradictions > point.views;
        // What too few views saw may be noise in front of a wall: that tells nothing of what moved.
        if (carved && point.seen_through) cells_.add_carved(point.p_world);
        return carved;
      });
      views.clear();
    };
    for_each_batch("carving", [&](size_t first, std::vector<ImageSurfels>& batch) {
      for (size_t i = 0; i < batch.size(); ++i) {
        const PosedImage& view = views_[first + i];
        views.push_back({view.T_world_camera.inverse(), view.velocity, view.depth_stamp_difference_s,
                         std::move(batch[i].nearest)});
      }
      if (views.size() >= kViews) flush();
    });
    flush();
  }

  void add(std::span<const SurfacePoint> points, ColoredCloud& cloud) {
    cloud.points.reserve(cloud.size() + points.size());
    cloud.normals.reserve(cloud.size() + points.size());
    for (const SurfacePoint& point : points) {
      cloud.points.push_back(point.p_world);
      cloud.colors.push_back(point.color);
      cloud.normals.push_back(point.normal);
      constexpr int kMost = std::numeric_limits<uint16_t>::max();
      surplus_.push_back(static_cast<uint16_t>(std::min(point.views - point.contradictions, kMost)));
    }
  }

  void remove_remnants(ColoredCloud& cloud) {
    const auto is_remnant = find_remnants(cloud.points, surplus_, cells_);
    const auto remove_from = [&](auto& values) {
      size_t i = 0;
      std::erase_if(values, [&](const auto&) { return is_remnant[i++] != 0; });
    };
    remove_from(cloud.points);
    remove_from(cloud.colors);
    remove_from(cloud.normals);
  }

  template <class Use>
  void for_each_batch(const char* what, const Use& use) {
    const auto batch_size = static_cast<size_t>(std::max(threads_, 1));
    for (size_t first = 0; first < views_.size(); first += batch_size) {
      if (!report(progress_, what, first, views_.size())) {
        stopped_ = true;
        return;
      }
      std::vector<ImageSurfels> batch(std::min(batch_size, views_.size() - first));
      parallel_for(batch.size(), threads_, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) batch[i] = load_surfels_(views_[first + i].image);
      });
      use(first, batch);
    }
    report(progress_, what, views_.size(), views_.size());
  }

  const SurfelLoader& load_surfels_;
  std::span<const PosedImage> views_;
  const DenseCamera& camera_;
  const DenseOptions& options_;
  int threads_;
  const Progress& progress_;
  RayTable rays_;
  CarvedCells cells_;
  std::vector<uint16_t> surplus_;  // of the points of the cloud, see find_remnants
  bool stopped_ = false;
};

}  // namespace

ColoredCloud fuse_surfels(const SurfelLoader& load_surfels, std::span<const PosedImage> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads,
                          const Progress& progress) {
  return Fusion(load_surfels, views, camera, options, threads, progress).run();
}

std::vector<Eigen::Vector3f> surface_normals(const SurfelLoader& load_surfels,
                                             std::span<const PosedImage> views, const DenseCamera& camera) {
  constexpr size_t kMaxViews = 60;
  constexpr size_t kMaxSurfels = 20'000;  // per view: all of an image of 160 x 120 pixels, which is plenty
  constexpr double kVoxelM = 0.05;
  constexpr float kMinAgreement = 0.95F;  // length of the mean of a voxel's normals
  const RayTable rays = ray_table(camera.color);
  VoxelGrid grid;
  const size_t step = views.size() / kMaxViews + 1;
  for (size_t i = 0; i < views.size(); i += step) {
    for (const VoxelSample& sample :
         voxel_samples(thinned(load_surfels(views[i].image), kMaxSurfels), views[i], camera, rays, kVoxelM)) {
      grid.add(sample, static_cast<uint32_t>(i));
    }
  }
  std::vector<Eigen::Vector3f> normals;
  for (const Voxel& voxel : grid.voxels()) {
    if (voxel.normal_sum.norm() >= kMinAgreement * voxel.weight)
      normals.push_back(voxel.normal_sum.normalized());
  }
  return normals;
}

}  // namespace kinloop
