#include "viewer/scene/incremental_cloud.hpp"

#include <utility>

#include "dense/surfels/voxel_grid.hpp"
#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

DenseOptions sampling(const ViewerOptions& options) {
  DenseOptions dense;
  dense.voxel_m = options.voxel_m;
  dense.limits = options.limits;
  return dense;
}

}  // namespace

IncrementalCloud::IncrementalCloud(const RgbdCamera& camera, const ViewerOptions& options)
    : camera_{.color = camera.color, .noise = camera.sensor.noise},
      rays_(ray_table(camera.color)),
      options_(sampling(options)) {}

CloudPiece IncrementalCloud::add_keyframe(KeyframeId anchor, const cv::Mat& color, const cv::Mat& depth_m,
                                          const SE3& T_world_camera) {
  VoxelGrid fresh;
  const ImageSurfels surfels = extract_surfels({color, depth_m}, {camera_.color.fx, camera_.noise}, options_);
  for (const VoxelSample& sample :
       voxel_samples(surfels, {.T_world_camera = T_world_camera}, camera_, rays_, options_.voxel_m)) {
    if (!seen_.contains(sample.key)) fresh.add(sample, 0);
  }
  CloudPiece piece{anchor, {}};
  const SE3 T_camera_world = T_world_camera.inverse();
  for (const Voxel& voxel : fresh.voxels()) {
    seen_.insert(voxel.key);
    const Eigen::Vector3d p_world = mean_point(voxel, options_.voxel_m).cast<double>();
    piece.cloud.points.emplace_back((T_camera_world * p_world).cast<float>());
    piece.cloud.colors.push_back(mean_color(voxel));
    normals_.push_back(voxel.normal_sum.normalized());
  }
  piece.cloud = shuffled(piece.cloud);
  return piece;
}

ColoredCloud shuffled(const ColoredCloud& cloud) {
  std::vector<uint32_t> order;
  order.reserve(cloud.size());
  for (uint32_t i = 0; i < cloud.size(); ++i) {
    if (is_drawable(cloud.points[i])) order.push_back(i);
  }
  Random random(order.size());
  for (uint32_t left = static_cast<uint32_t>(order.size()); left > 1; --left) {
    std::swap(order[left - 1], order[random.index(left)]);  // Fisher and Yates
  }
  ColoredCloud mixed;
  mixed.points.reserve(order.size());
  mixed.colors.reserve(order.size());
  for (const uint32_t i : order) {
    mixed.points.push_back(cloud.points[i]);
    mixed.colors.push_back(cloud.colors[i]);
  }
  return mixed;
}

}  // namespace kinloop
