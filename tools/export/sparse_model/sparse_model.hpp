#pragma once
// In: a map, and the poses of its images. Out: cameras, points and tracks in the way of structure from
// motion, for COLMAP and for programs that learn radiance fields or Gaussian splats.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "kinloop/map/map.hpp"
#include "tools/export/sparse_model/image_undistorter.hpp"

namespace kinloop {

/// Both coordinates of the centre of the top left pixel in files of COLMAP and Nerfstudio; ours are 0.
inline constexpr double kPixelCenter = 0.5;

/// A stored image with its pose, and the frame that it belongs to.
struct FrameImage {
  FrameId frame;
  PosedImage view;
  int64_t stamp_ns = 0;
};

/// Point `point` of the model as seen in an image.
struct ModelObservation {
  Eigen::Vector2d pixel;  ///< of the pinhole camera
  uint32_t point = 0;
};

struct ModelImage {
  std::string name;   ///< without folder and extension
  size_t stored = 0;  ///< index into the ImageStore
  int64_t stamp_ns = 0;
  Velocity velocity;
  SE3 T_file_camera;
  std::vector<ModelObservation> observations;  ///< none unless the frame is a keyframe
};

/// Observation `observation` of image `image`.
struct TrackElement {
  uint32_t image = 0;
  uint32_t observation = 0;
};

struct ModelPoint {
  Eigen::Vector3d p_file;
  Rgb color = {};                        ///< of landmarks: set by write_model_images
  double error_px = 0;                   ///< mean reprojection error
  std::vector<TrackElement> track = {};  ///< empty for points of the cloud
};

/// Everything is in the frame of the file.
struct SparseModel {
  PinholeCamera camera;
  FileFrame frame;
  std::vector<ModelImage> images;
  std::vector<ModelPoint> points;
};

/// Observations that are further from the projection of their point are left out, as COLMAP does by default.
constexpr double kMaxReprojectionErrorPx = 4;

/// Returns the images with finite poses, and the landmarks that at least two of them observe. A landmark
/// follows the pose of its anchor's image; without that image it is left out.
SparseModel make_sparse_model(const Map& map, std::span<const FrameImage> views,
                              const ImageUndistorter& undistorter, const FileFrame& frame);

/// Adds `count` points of a cloud in the world frame, or all that it has, evenly over its surface and always
/// the same. They have no track.
void add_cloud_points(SparseModel& model, const ColoredCloud& cloud, size_t count);

}  // namespace kinloop
