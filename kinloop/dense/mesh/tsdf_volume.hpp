#pragma once
// In: posed depth images. Out: the surfaces between what they saw as free and what they saw as solid, as
// triangles. A truncated signed distance field (Curless and Levoy 1996) in a sparse OpenVDB volume, where
// OpenVDB was there when the library was built.

#include <memory>

#include <opencv2/core/mat.hpp>

#include "kinloop/dense/mesh/colored_mesh.hpp"
#include "kinloop/dense/options.hpp"
#include "kinloop/dense/posed_image.hpp"

namespace kinloop {

/// Whether this build has OpenVDB.
bool tsdf_available();

/// A depth image, undistorted, with what each pixel may be used for.
struct TsdfView {
  cv::Mat depth_m;  ///< 32FC1, of an ideal camera; 0 = unknown
  cv::Mat usable;   ///< 8UC1: not at a depth edge, in range: may say where a surface is
  SE3 T_world_camera;
  Vector6d velocity = Vector6d::Zero();  ///< see PosedImage
};

class TsdfVolume {
 public:
  /// Throws UsageError where this build has no OpenVDB.
  TsdfVolume(const DenseCamera& camera, const MeshOptions& options);
  ~TsdfVolume();
  TsdfVolume(const TsdfVolume&) = delete;
  TsdfVolume& operator=(const TsdfVolume&) = delete;

  /// Makes room for the surfaces that the view saw.
  void allocate_blocks(const TsdfView& view);

  /// Adds what the view saw, where there is room: surfaces, and that there is nothing in front of them. With
  /// room made for all views before, their order does not matter but for rounding. The result does not depend
  /// on `threads`.
  void integrate(const TsdfView& view, int threads);

  /// The surfaces as triangles, without colours.
  [[nodiscard]] ColoredMesh surface() const;

  [[nodiscard]] size_t bytes() const;

 private:
  struct Volume;

  DenseCamera camera_;
  MeshOptions options_;
  std::unique_ptr<Volume> volume_;
};

}  // namespace kinloop
