#include "dense/surfels/surface_normals.hpp"

#include "dense/surfels/voxel_grid.hpp"

namespace kinloop {

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
