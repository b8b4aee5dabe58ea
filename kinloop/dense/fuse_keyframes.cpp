#include "kinloop/dense/fuse_keyframes.hpp"

#include <algorithm>
#include <array>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/dense/voxel_grid.hpp"

namespace kinloop {
namespace {

// Space is dealt out to this many grids by the voxels' scattered keys. Each grid takes the images in their
// order whichever thread fills it, so that nothing depends on threads.
constexpr int kGridBits = 4;
constexpr size_t kGrids = 1 << kGridBits;

/// The samples of one image, by grid.
using DealtSamples = std::array<std::vector<VoxelSample>, kGrids>;

DealtSamples deal(const std::vector<VoxelSample>& samples) {
  constexpr int kKeyBits = 64;
  DealtSamples dealt;
  for (auto& part : dealt) part.reserve(samples.size() / kGrids * 5 / 4);
  for (const VoxelSample& sample : samples)
    dealt[scatter(sample.key) >> (kKeyBits - kGridBits)].push_back(sample);
  return dealt;
}

ColoredCloud cloud_of(const std::array<VoxelGrid, kGrids>& grids, const DenseOptions& options) {
  std::vector<const Voxel*> kept;
  for (const VoxelGrid& grid : grids) {
    for (const Voxel& voxel : grid.voxels()) {
      if (voxel.views >= options.min_observations) kept.push_back(&voxel);
    }
  }
  std::sort(kept.begin(), kept.end(), [](const Voxel* a, const Voxel* b) { return a->key < b->key; });
  ColoredCloud cloud;
  cloud.points.reserve(kept.size());
  cloud.colors.reserve(kept.size());
  for (const Voxel* voxel : kept) {
    cloud.points.push_back(mean_point(*voxel, options.voxel_m));
    cloud.colors.push_back(mean_color(*voxel));
  }
  return cloud;
}

}  // namespace

ColoredCloud fuse_keyframes(const KeyframeImages& images, std::span<const PosedImage> views,
                            const PinholeCamera& camera, const DenseOptions& options, int threads,
                            const Progress& progress) {
  const RayTable rays = ray_table(camera);
  std::array<VoxelGrid, kGrids> grids;
  const auto batch_size = static_cast<size_t>(std::max(threads, 1));
  std::vector<DealtSamples> batch(batch_size);
  for (size_t first = 0; first < views.size(); first += batch_size) {
    if (!report(progress, "fusing", first, views.size())) break;
    const size_t count = std::min(batch_size, views.size() - first);
    parallel_for(count, threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const PosedImage& view = views[first + i];
        const RgbdImages seen = images.load(view.image);
        batch[i] = deal(voxel_samples(seen.color, seen.depth_m, view.T_world_camera, rays, options));
      }
    });
    parallel_for(kGrids, threads, [&](size_t begin, size_t end) {
      for (size_t grid = begin; grid < end; ++grid) {
        for (size_t i = 0; i < count; ++i) {
          for (const VoxelSample& sample : batch[i][grid]) {
            grids[grid].add(sample, static_cast<uint32_t>(first + i));
          }
        }
      }
    });
  }
  report(progress, "fusing", views.size(), views.size());
  return cloud_of(grids, options);
}

}  // namespace kinloop
