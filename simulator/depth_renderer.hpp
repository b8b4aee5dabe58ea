#pragma once
// In: a scene and a depth camera. Out: what the camera looks at, exactly, all rows at one moment.

#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "simulator/exact_depth.hpp"
#include "simulator/scene.hpp"

namespace kinloop::sim {

/// How many rays a pixel has: one through its centre, or four that fill it.
enum class SamplesPerPixel { kOne = 1, kFour = kLanes };

/// Renders the exact depth of a camera with a global shutter, as depth cameras of time of flight and stereo
/// have. Rows are independent, so the result is the same for any number of threads.
class DepthRenderer {
 public:
  DepthRenderer(const Scene& scene, const PinholeCamera& camera, SamplesPerPixel samples, int threads);

  /// Rays that hit nothing have cosine 0.
  [[nodiscard]] ExactDepth render(const SE3& T_room_camera) const;

  /// Returns the length of each pixel's ray at depth 1, 32FC1: range = this x depth.
  [[nodiscard]] const cv::Mat& range_per_depth() const { return range_per_depth_; }

 private:
  struct Tile;
  struct Row;

  void add_rays(const Eigen::Vector2d& pixel);
  [[nodiscard]] Tile tile_rays(const SE3& T_room_camera, size_t first, size_t count) const;
  void render_tile(const Tile& tile, size_t count, const Row& out) const;

  const Scene* scene_;
  PinholeCamera camera_;
  int samples_, threads_;
  std::vector<float> ray_x_, ray_y_;  ///< ray (x, y, 1) of every sample, those of a pixel in succession
  cv::Mat range_per_depth_;
};

}  // namespace kinloop::sim
