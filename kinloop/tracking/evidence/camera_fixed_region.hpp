#pragma once
// Finds the part of the image that moves with the camera: the robot that carries it, a gripper, a hood. No
// pose is needed, and none could help, since a tracker that follows that part finds every pose wrong but its
// own: whatever keeps its depth and its brightness while the rest of the image changes again and again is
// fixed to the camera.

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"

namespace kinloop {

/// Watches the points of the surface grid over time.
class CameraFixedRegion {
 public:
  /// Adds a prepared frame, as measured. Returns whether the region has grown.
  bool observe(const Frame& frame);

  /// Returns the points of the region, marked on the surface grid (see surface_mask.hpp); empty if there are
  /// none.
  [[nodiscard]] const cv::Mat& points() const { return marked_; }

  /// Returns the camera of the grid; null before the first frame.
  [[nodiscard]] const std::shared_ptr<const SurfaceCamera>& camera() const { return camera_; }

  /// Returns the region's share of the image, 0 to 1.
  [[nodiscard]] double share() const { return marked_share(marked_); }

  /// Returns since when the points by which the region has grown last have not changed.
  [[nodiscard]] int64_t unchanged_since_ns() const { return unchanged_since_ns_; }

 private:
  struct Point {
    float inverse_depth_per_m = 0;  // when it last changed; 0 = unknown
    float gray = 0;                 // likewise
    int64_t since_ns = 0;           // of the last change
    float unchanged = 0;            // how often the points of the room have changed since, on average
    bool fixed = false;             // in the region
  };

  void begin(const Frame& frame);
  std::vector<uint8_t> update_points(const Frame& frame);
  void count_changes(const std::vector<uint8_t>& changed);
  [[nodiscard]] bool has_structure(const cv::Mat& labels, int x, int y) const;
  bool grow();
  void mark();

  std::shared_ptr<const SurfaceCamera> camera_;
  std::vector<Point> points_;
  cv::Mat marked_;
  int64_t unchanged_since_ns_ = 0;
};

}  // namespace kinloop
