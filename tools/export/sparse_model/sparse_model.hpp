#pragma once
// In: a map, and the poses of its images. Out: cameras, points and tracks in the way of structure from
// motion, for COLMAP and for programs that learn radiance fields or Gaussian splats.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "dense/image_store.hpp"
#include "kinloop/core/progress.hpp"
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

/// Writes COLMAP's text model: sparse/0/cameras.txt, images.txt and points3D.txt into `folder`, each
/// atomically; the images are those that `write_model_images` writes. Ids count from 1. COLMAP's pixels are
/// half a pixel larger: (0.5, 0.5) is the centre of the top left one. Throws InputError on failure.
void write_colmap_model(const std::filesystem::path& folder, const SparseModel& model);

/// Writes the data set of Nerfstudio and instant-ngp: sparse_pc.ply (the points) and transforms.json into
/// `folder`, each atomically; images and depth are those that `write_model_images` writes. Cameras have
/// OpenGL's axes: x right, y up, z backwards. Throws InputError on failure.
void write_nerfstudio(const std::filesystem::path& folder, const SparseModel& model);

struct ModelImageOptions {
  bool depth = false;  ///< also write depth/NAME.png: 16 bits, mm, 0 = unknown
  int threads = 1;
};

/// Writes images/NAME.jpg, each atomically, and sets the colours of the points. Images that are those of a
/// pinhole camera already keep their bytes. Throws InputError on failure.
void write_model_images(const std::filesystem::path& folder, SparseModel& model, const ImageStore& store,
                        const ImageUndistorter& undistorter, const ModelImageOptions& options,
                        const Progress& progress = {});

}  // namespace kinloop
