#pragma once

#include <algorithm>

#include "kinloop/core/options.hpp"
#include "kinloop/sensor/depth_sensor.hpp"

namespace kinloop {

/// Limits of the depths used in dense maps.
struct DepthLimits {
  double min_depth_m = 0.4;
  double max_depth_m = 4.0;       ///< beyond it the noise of a Kinect 1 exceeds 2 cm
  double max_incidence_deg = 78;  ///< between the ray and the surface normal

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("min_depth_m", self.min_depth_m,
          "minimum depth, metres; also of meshes and occupancy maps (default: that of the sensor if it is "
          "known, less in a near scene)",
          Range{0.05, 10});
    visit("max_depth_m", self.max_depth_m,
          "maximum depth, metres; also of meshes, occupancy maps and the live view; not beyond that of the "
          "sensor",
          Range{0.1, 13});
    visit(
        "max_incidence_deg", self.max_incidence_deg,
        "maximum incidence angle of a surface; steeper ones, and flying pixels at depth edges, are dropped, "
        "degrees",
        Range{10, 89.9}, Expert{});
  }
};

/// Returns the limits without what is beyond the range of the sensor, unless the sensor is only assumed.
inline DepthLimits within_range(DepthLimits limits, const DepthSensor& sensor) {
  if (sensor.origin == SensorOrigin::kAssumed) return limits;
  limits.max_depth_m = std::min(limits.max_depth_m, sensor.max_depth_m);
  return limits;
}

/// Options of the fusion of posed depth images into a coloured cloud.
struct DenseOptions {
  double voxel_m = 0.01;
  DepthLimits limits = {};
  int min_observations = 2;
  bool carve = true;
  bool compensate_exposure = true;
  int frame_step = 0;
  bool surfels_at_end = false;
  int jpeg_quality = 95;
  int image_memory_mib = 64;
  int surfel_memory_mib = 0;
  int fusion_memory_mib = 256;
  double up_x = 0, up_y = 0, up_z = 0;  ///< all 0: estimated

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "voxel size, metres", Range{0.001, 0.5});
    DepthLimits::fields(self.limits, visit);
    visit("min_observations", self.min_observations,
          "minimum images that observe a voxel, or all images that cover it if fewer", Range{1, 100});
    visit("carve", self.carve,
          "space carving: drop points with more free-space violations than observations");
    visit("compensate_exposure", self.compensate_exposure,
          "compensate changes of exposure and white balance between images");
    visit("frame_step", self.frame_step, "also fuse every n-th frame; 0: only where keyframes are sparse",
          Range{0, 10000});
    visit("surfels_at_end", self.surfels_at_end,
          "compute the surfels of images when the cloud is made, not during the run; does not affect the "
          "results");
    visit("jpeg_quality", self.jpeg_quality, "JPEG quality of the stored colour images", Range{50, 100},
          Expert{});
    visit("image_memory_mib", self.image_memory_mib,
          "memory for stored images before spilling to a temporary file, MiB", Range{0, 1e6});
    visit("surfel_memory_mib", self.surfel_memory_mib,
          "memory for surfels before spilling to a temporary file, MiB", Range{0, 1e6});
    visit("fusion_memory_mib", self.fusion_memory_mib,
          "memory for voxels during fusion; larger maps are fused in slabs, MiB", Range{1, 1e6});
    constexpr Range kAxis{-1e6, 1e6};
    visit("up_x", self.up_x,
          "up direction in the axes of the first camera, to the right (--up); all three 0: estimated from "
          "surfaces",
          kAxis, Expert{});
    visit("up_y", self.up_y, "same, down", kAxis, Expert{});
    visit("up_z", self.up_z, "same, forward", kAxis, Expert{});
  }
};

/// Options of the mesh.
struct MeshOptions {
  double voxel_m = 0.01;
  double truncation_voxels = 4;
  DepthLimits limits = {};  ///< not separate options: the program uses those of the dense map
  double min_weight = 0.02;
  int min_component_triangles = 200;
  int triangles = 0;
  bool manifold = false;
  int texture_px = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "voxel size, metres", Range{0.001, 0.5});
    visit("truncation_voxels", self.truncation_voxels, "TSDF truncation distance, voxels", Range{1, 20},
          Expert{});
    visit("min_weight", self.min_weight,
          "minimum TSDF weight of a voxel; one image at z m weighs 1 / z^4 (Kinect 1; others by their noise)",
          Range{0, 1e6}, Expert{});
    visit("min_component_triangles", self.min_component_triangles,
          "minimum triangles of a connected component", Range{0, 1e9});
    visit("triangles", self.triangles, "simplify to at most so many triangles (0: as measured)",
          Range{0, 1e9});
    visit("manifold", self.manifold, "separate surfaces that touch, as tools that edit meshes need it");
    visit("texture_px", self.texture_px,
          "maximum width and height of a texture made from the images, pixels (0: no texture, but colours of "
          "vertices)",
          Range{0, 16384});
  }
};

/// Options of the occupancy map.
struct OccupancyOptions {
  double voxel_m = 0.05;
  int stride_px = 4;
  DepthLimits limits = {};  ///< not separate options: the program uses those of the dense map
  double grid_min_height_m = 0.1;
  double grid_max_height_m = 1.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "voxel size, metres", Range{0.005, 1});
    visit("stride_px", self.stride_px, "use every n-th pixel of every n-th row", Range{1, 64}, Expert{});
    visit("grid_min_height_m", self.grid_min_height_m,
          "minimum height of an obstacle above the floor, metres", Range{-10, 10});
    visit("grid_max_height_m", self.grid_max_height_m,
          "maximum height of an obstacle above the floor, metres", Range{-10, 100});
  }
};

}  // namespace kinloop
