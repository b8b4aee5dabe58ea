#include "dense/mesh/reconstruct_mesh.hpp"

#include <algorithm>
#include <functional>

#include "dense/cloud/point_colors.hpp"
#include "dense/mesh/simplify_mesh.hpp"
#include "dense/undistorted_images.hpp"
#include "dense/usable_depth.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// Removes the depth deformation from an undistorted depth image.
cv::Mat corrected_depth(cv::Mat depth_m, const DenseCamera& camera) {
  if (camera.inverse_depth_correction.isZero(0)) return depth_m;
  for (int row = 0; row < depth_m.rows; ++row) {
    for (int col = 0; col < depth_m.cols; ++col) {
      auto& z = depth_m.at<float>(row, col);
      if (!(z > 0)) continue;
      const Eigen::Vector3d ray = camera.color.unproject(Eigen::Vector2d(col, row), 1);
      const double inverse_depth = camera.correct_inverse_depth(1 / static_cast<double>(z), ray.x(), ray.y());
      z = inverse_depth > 0 ? static_cast<float>(1 / inverse_depth) : 0.0F;
    }
  }
  return depth_m;
}

/// Calls `use` with every view in order; `threads` threads decode ahead.
void for_each_view(const StoredViews& stored, const MeshOptions& options, int threads,
                   const std::function<bool(size_t index, const UndistortedDepth& view)>& use) {
  const std::span<const PosedImage> views = stored.views;
  const cv::Mat raw_pixels = undistortion_of(stored.camera.color);
  const DepthLimits& limits = options.limits;
  const auto batch_size = static_cast<size_t>(std::max(threads, 1));
  std::vector<UndistortedDepth> batch(batch_size);
  for (size_t first = 0; first < views.size(); first += batch_size) {
    const size_t count = std::min(batch_size, views.size() - first);
    parallel_for(count, threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const cv::Mat depth_m = stored.images.load(views[first + i].image).depth_m;
        const cv::Mat usable =
            undistorted(usable_pixels(depth_m, stored.camera.color.fx, limits), raw_pixels);
        batch[i] = {corrected_depth(undistorted(depth_m, raw_pixels), stored.camera), usable,
                    views[first + i].T_world_camera, views[first + i].velocity,
                    views[first + i].depth_stamp_difference_s};
      }
    });
    for (size_t i = 0; i < count; ++i) {
      if (!use(first + i, batch[i])) return;
    }
  }
}

ColoredMesh simplified_as_asked(const ColoredMesh& mesh, const MeshOptions& options) {
  const auto smallest = static_cast<size_t>(options.min_component_triangles);
  if (options.triangles == 0) return options.manifold ? manifold_mesh(mesh, smallest) : mesh;
  ColoredMesh simplified = simplified_mesh(mesh, static_cast<size_t>(options.triangles), smallest);
  if (simplified.triangles.size() > static_cast<size_t>(options.triangles)) {
    log::warn(
        "the mesh has {} triangles, more than the {} of mesh.triangles: separate pieces cannot be "
        "simplified further; larger voxels (mesh.voxel_m) give fewer pieces",
        simplified.triangles.size(), options.triangles);
  }
  return simplified;
}

}  // namespace

ColoredMesh reconstruct_mesh(const StoredViews& stored, const MeshOptions& options, int threads,
                             const Progress& progress) {
  validate(options, "mesh.");
  validate(options.limits, "mesh.");
  if (options.triangles > 0 || options.manifold) require_mesh_simplification();
  TsdfVolume volume(stored.camera, options);
  // Two passes over the images, so that earlier views can also carve away what later ones saw only briefly.
  for_each_view(stored, options, threads, [&](size_t, const UndistortedDepth& view) {
    volume.allocate_blocks(view);
    return true;
  });
  for_each_view(stored, options, threads, [&](size_t index, const UndistortedDepth& view) {
    volume.integrate(view, threads);
    return report(progress, "meshing", index + 1, stored.views.size());
  });
  const ColoredMesh measured =
      remove_small_components(volume.surface(), static_cast<size_t>(options.min_component_triangles));
  ColoredMesh mesh = simplified_as_asked(measured, options);
  mesh.colors = color_points(mesh.points, vertex_normals(mesh), stored, threads, progress);
  return mesh;
}

}  // namespace kinloop
