#pragma once

#include "kinloop/base/options.hpp"

namespace kinloop {

/// How posed depth images become one coloured cloud.
struct DenseOptions {
  double voxel_m = 0.01;
  double min_m = 0.4;
  double max_m = 4.0;
  double max_slope_deg = 78;
  int min_observations = 2;
  bool carve = true;
  bool even_exposure = true;
  int frame_step = 0;
  int jpeg_quality = 95;
  int image_memory_mib = 64;
  int patch_memory_mib = 0;
  int fusion_memory_mib = 256;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "edge of a voxel, metres", Range{0.001, 0.5});
    visit("min_m", self.min_m, "nearest depth used, metres", Range{0.05, 10});
    visit("max_m", self.max_m, "farthest depth used, metres", Range{0.1, 13});
    visit("max_slope_deg", self.max_slope_deg,
          "leaves out surfaces that turn away from the ray by more, and with them the flying pixels at depth "
          "edges, degrees",
          Range{10, 89.9});
    visit("min_observations", self.min_observations,
          "images that must have seen a voxel for it to stay; all of them where fewer looked there",
          Range{1, 100});
    visit("carve", self.carve, "leaves out what more images saw through than saw: people who passed by");
    visit("even_exposure", self.even_exposure,
          "evens out what automatic exposure and white balance change from image to image");
    visit("frame_step", self.frame_step,
          "beside the keyframes, fuses every n-th frame; 0: others only where keyframes are few",
          Range{0, 10000});
    visit("jpeg_quality", self.jpeg_quality, "of the colour images that are kept for fusing", Range{50, 100});
    visit("image_memory_mib", self.image_memory_mib,
          "memory for the images that are kept for fusing; the rest goes to a temporary file, MiB",
          Range{0, 1e6});
    visit("patch_memory_mib", self.patch_memory_mib,
          "memory for what was worked out of them; the rest goes to a temporary file, MiB", Range{0, 1e6});
    visit("fusion_memory_mib", self.fusion_memory_mib,
          "memory for voxels while fusing; a map that needs more is fused part by part, MiB", Range{1, 1e6});
  }
};

/// How posed depth images become a mesh.
struct MeshOptions {
  double voxel_m = 0.01;
  double truncation_voxels = 4;
  double min_m = 0.4;
  double max_m = 4.0;
  double max_slope_deg = 78;
  double min_weight = 0.02;
  int min_piece = 200;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "edge of a voxel, metres", Range{0.001, 0.5});
    visit("truncation_voxels", self.truncation_voxels,
          "how far before and behind a surface its distance is kept, voxels", Range{1, 20});
    visit("min_m", self.min_m, "nearest depth used, metres", Range{0.05, 10});
    visit("max_m", self.max_m, "farthest depth used, metres", Range{0.1, 13});
    visit("max_slope_deg", self.max_slope_deg,
          "leaves out surfaces that turn away from the ray by more, degrees", Range{10, 89.9});
    visit("min_weight", self.min_weight,
          "a voxel counts as seen from this weight on; one image at 1 m weighs 1, at z m 1 / z^4",
          Range{0, 1e6});
    visit("min_piece", self.min_piece, "loose pieces of fewer triangles are left out", Range{0, 1e9});
  }
};

/// How posed depth images become a map of free and occupied space.
struct OccupancyOptions {
  double voxel_m = 0.05;
  int stride_px = 4;
  double min_m = 0.4;
  double max_m = 4.0;
  double max_slope_deg = 78;
  double grid_low_m = 0.1;
  double grid_high_m = 1.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "edge of a voxel, metres", Range{0.005, 1});
    visit("stride_px", self.stride_px, "takes every n-th pixel of every n-th row", Range{1, 64});
    visit("min_m", self.min_m, "nearest depth used, metres", Range{0.05, 10});
    visit("max_m", self.max_m, "farthest depth used, metres", Range{0.1, 13});
    visit("max_slope_deg", self.max_slope_deg,
          "leaves out surfaces that turn away from the ray by more, degrees", Range{10, 89.9});
    visit("grid_low_m", self.grid_low_m, "what is lower above the floor is no obstacle of the grid, metres",
          Range{-10, 10});
    visit("grid_high_m", self.grid_high_m,
          "what is higher above the floor is no obstacle of the grid, metres", Range{-10, 100});
  }
};

}  // namespace kinloop
