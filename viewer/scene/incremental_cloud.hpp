#pragma once
// In: posed images, one after the other. Out: of each the points that no image before has shown.

#include <unordered_set>

#include "kinloop/dense/cloud/voxel_samples.hpp"
#include "viewer/options.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {

class IncrementalCloud {
 public:
  IncrementalCloud(const PinholeCamera& camera, const ViewerOptions& options);

  /// The new points, in the camera frame of the keyframe `anchor`.
  CloudPiece add_keyframe(KeyframeId anchor, const cv::Mat& color, const cv::Mat& depth_m,
                          const SE3& T_world_camera);

  /// The normal of every point given out so far, in the world as it was at the time.
  [[nodiscard]] const std::vector<Eigen::Vector3f>& normals() const { return normals_; }

  /// Points given out so far.
  [[nodiscard]] size_t size() const { return seen_.size(); }

 private:
  DenseCamera camera_;
  RayTable rays_;
  DenseOptions options_;
  std::unordered_set<VoxelKey> seen_;
  std::vector<Eigen::Vector3f> normals_;
};

/// The points in a random order that is the same every time: any first part of them is then a thinner cloud
/// of the same place, which is what a browser draws when it cannot draw all.
ColoredCloud shuffled(const ColoredCloud& cloud);

}  // namespace kinloop
