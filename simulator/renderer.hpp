#pragma once
// In: a scene, a camera and its path. Out: the two images of a frame, each row rendered from the camera pose
// at its readout time.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/depth_stamps.hpp"
#include "simulator/kinect_model.hpp"
#include "simulator/scene.hpp"

namespace kinloop::sim {

/// Renders frames of one scene. Rows are independent, so the result is the same for any number of threads.
class Renderer {
 public:
  Renderer(const Scene& scene, const PinholeCamera& camera, const KinectNoise& noise, int threads);

  /// `path` is in the room frame; the stamp of colour is the middle of the exposure of the middle row. The
  /// frame has no id.
  [[nodiscard]] RgbdFrame render(const CameraPath& path, const FrameStamps& stamps,
                                 uint64_t frame_seed) const;

 private:
  struct RowImages;
  struct RowPoses;
  struct Tile;

  [[nodiscard]] int64_t row_stamp_ns(int64_t stamp_ns, int row) const;
  [[nodiscard]] int color_packets(const CameraPath& path, int64_t stamp_ns) const;
  [[nodiscard]] RowPoses row_poses(const CameraPath& path, const FrameStamps& row, int packets) const;
  [[nodiscard]] Tile tile_rays(const RowPoses& poses, int row, int begin) const;
  [[nodiscard]] cv::Vec3b to_bgr8(Lanes bgr, float gain, uint64_t bits) const;
  void render_tile(const Tile& tile, float gain, uint64_t seed, const RowImages& out) const;

  const Scene* scene_;
  PinholeCamera camera_;
  KinectNoise noise_;
  int threads_;
  std::vector<float> ray_x_, ray_y_;  ///< ray (x, y, 1) of every pixel centre
};

}  // namespace kinloop::sim
