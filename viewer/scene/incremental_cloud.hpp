#pragma once
// In: posed images, one after the other. Out: for each, the points that no earlier image has shown.

#include <unordered_set>

#include "dense/surfels/voxel_samples.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "session/plan/viewer_options.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {

class IncrementalCloud {
 public:
  IncrementalCloud(const RgbdCamera& camera, const ViewerOptions& options);

  /// Returns the new points, in the camera frame of the keyframe `anchor`.
  CloudPiece add_keyframe(KeyframeId anchor, const cv::Mat& color, const cv::Mat& depth_m,
                          const SE3& T_world_camera);

  /// The normals of all points so far, in the world frame at the time of insertion.
  [[nodiscard]] const std::vector<Eigen::Vector3f>& normals() const { return normals_; }

  /// Number of points so far.
  [[nodiscard]] size_t size() const { return seen_.size(); }

 private:
  DenseCamera camera_;
  RayTable rays_;
  DenseOptions options_;
  std::unordered_set<VoxelKey> seen_;
  std::vector<Eigen::Vector3f> normals_;
};

/// Returns the drawable points in a deterministic random order, so that any prefix is a thinned cloud;
/// browsers draw a prefix if they cannot draw all points.
ColoredCloud shuffled(const ColoredCloud& cloud);

}  // namespace kinloop
