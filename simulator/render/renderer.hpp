#pragma once
// In: a scene, a camera and its path. Out: the images of a frame, each row rendered from the camera pose at
// its readout time. What moves is posed once for a few rows.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/render/moment.hpp"
#include "simulator/sensors/depth_stamps.hpp"
#include "simulator/sensors/kinect_model.hpp"

namespace kinloop::sim {

/// Which images to render.
enum class RenderedImages { kColor, kColorAndDepth };

/// Renders frames of one scene, with the depth of a Kinect 1 where asked. Rows are independent, so the result
/// is the same for any number of threads.
class Renderer {
 public:
  Renderer(const Scene& scene, const PinholeCamera& camera, const KinectNoise& noise, RenderedImages images,
           int threads);

  /// `path` is in the room frame; the stamp of colour is the middle of the exposure of the middle row. The
  /// frame has no id.
  [[nodiscard]] Frame render(const CameraPath& path, const FrameStamps& stamps, uint64_t frame_seed) const;

  /// Returns where the colour image of such a frame shows what moves, 8UC1: 255 = moving, 128 = at rest.
  [[nodiscard]] cv::Mat mover_mask(const CameraPath& path, const FrameStamps& stamps) const;

 private:
  struct Exposure;
  struct RowPoses;
  struct Tile;
  struct View;

  [[nodiscard]] int64_t row_stamp_ns(int64_t stamp_ns, int row) const;
  [[nodiscard]] int rows_per_moment() const;
  [[nodiscard]] std::vector<Moment> moments(int64_t stamp_ns) const;
  [[nodiscard]] int color_packets(const CameraPath& path, int64_t stamp_ns) const;
  [[nodiscard]] RowPoses row_poses(const CameraPath& path, const FrameStamps& row, int packets) const;
  [[nodiscard]] Tile tile_rays(const RowPoses& poses, int row, int begin) const;
  [[nodiscard]] cv::Vec3b to_bgr8(Lanes bgr, float gain, uint64_t bits) const;
  void render_color(const Tile& tile, const View& view, const Exposure& exposure, cv::Mat& out) const;
  void render_depth(const Tile& tile, const View& view, ExactDepth& out) const;
  void mark_movers(const Tile& tile, const View& view, cv::Mat& out) const;

  const Scene* scene_;
  PinholeCamera camera_;
  KinectNoise noise_;
  bool with_depth_;
  int threads_;
  std::vector<float> ray_x_, ray_y_;  ///< ray (x, y, 1) of every pixel centre
};

}  // namespace kinloop::sim
