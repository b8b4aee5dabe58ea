#pragma once
// In: depth as measured by the depth camera. Out: depth per pixel of the colour camera.

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Registers depth to colour: renders the surface through neighbouring depth pixels into the colour image
/// with a z-buffer. Neighbours across a depth jump are not joined, so edges stay sharp; pixels occluded from
/// the depth camera stay unknown.
class DepthRegistration {
 public:
  /// Requires `camera.depth`.
  explicit DepthRegistration(const RgbdCamera& camera);

  /// Returns 32FC1 of the colour camera's size from 32FC1 of the depth camera's; 0 = unknown in both.
  [[nodiscard]] cv::Mat operator()(const cv::Mat& depth_m) const;

 private:
  /// A depth pixel in the colour image; inverse_depth is 0 if unknown or out of view.
  struct Vertex {
    float x = 0, y = 0;  ///< px
    float inverse_depth = 0;
    float depth_m = 0;  ///< as measured
  };

  [[nodiscard]] Vertex vertex(const Eigen::Vector2f& ray, float depth_m) const;
  void draw(cv::Mat& image, const Vertex& a, const Vertex& b, const Vertex& c) const;

  PinholeCamera color_, depth_;
  Eigen::Matrix3f R_color_depth_;
  Eigen::Vector3f t_color_depth_;
  float longest_side_px_;              ///< limit for a triangle in the colour image
  std::vector<Eigen::Vector2f> rays_;  ///< of each depth pixel, x/z and y/z
};

/// Depth as a source reads it, to depth as its frames have it: shifted by the camera's `depth_shift_m`, and
/// registered to colour if the camera has a depth camera of its own.
class DepthPreparation {
 public:
  explicit DepthPreparation(const RgbdCamera& camera) : camera_(camera) {}

  /// Works on the pixels of `depth_m`, which must have the size of the depth camera.
  [[nodiscard]] cv::Mat operator()(cv::Mat depth_m);

 private:
  RgbdCamera camera_;
  std::optional<DepthRegistration> registration_;  // made when the first image shows that the size is true
};

/// Returns the camera of frames whose depth is already registered and shifted: no depth camera of its own.
RgbdCamera registered(RgbdCamera camera);

/// Returns the camera of an image scaled to a width of `width` pixels.
PinholeCamera resized(const PinholeCamera& camera, int width);

}  // namespace kinloop
