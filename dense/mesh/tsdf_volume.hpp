#pragma once
// In: posed depth images. Out: a triangle mesh of the observed surfaces. A truncated signed distance field
// (Curless and Levoy 1996) in a sparse OpenVDB volume; OpenVDB is an optional dependency.

#include <memory>

#include <opencv2/core/mat.hpp>

#include "dense/mesh/colored_mesh.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"

namespace kinloop {

/// Returns whether this build has OpenVDB.
bool tsdf_available();

/// An undistorted depth image and the use of its pixels.
struct UndistortedDepth {
  cv::Mat depth_m;  ///< 32FC1, of an ideal camera; 0 = unknown
  cv::Mat usable;   ///< 8UC1: nonzero if in range and not at a depth edge, i.e. may define a surface
  SE3 T_world_camera;
  Velocity velocity = {};
  double depth_stamp_difference_s = 0;  ///< PosedImage::depth_stamp_difference_s
};

class TsdfVolume {
 public:
  /// Throws UsageError if the build has no OpenVDB.
  TsdfVolume(const DenseCamera& camera, const MeshOptions& options);
  ~TsdfVolume();
  TsdfVolume(const TsdfVolume&) = delete;
  TsdfVolume& operator=(const TsdfVolume&) = delete;

  /// Allocates blocks for the surfaces that the view saw.
  void allocate_blocks(const UndistortedDepth& view);

  /// Integrates a view, surfaces and free space, into the allocated blocks. If the blocks of all views were
  /// allocated before, the order of views matters only for rounding. The result does not depend on `threads`.
  void integrate(const UndistortedDepth& view, int threads);

  /// Extracts the surfaces as triangles without colours.
  [[nodiscard]] ColoredMesh surface() const;

  [[nodiscard]] size_t bytes() const;

 private:
  struct Volume;

  DenseCamera camera_;
  MeshOptions options_;
  std::unique_ptr<Volume> volume_;
};

}  // namespace kinloop
