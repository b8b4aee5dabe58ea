#pragma once
// In: depth as the depth camera measured it. Out: the depth that each pixel of the colour camera sees.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Registers depth to colour: the surface through neighbouring depth pixels is drawn into the colour image,
/// the nearest wins (z-buffer). Neighbours whose depths jump are not joined, so that an edge stays an edge;
/// what the depth camera does not see, because something is before it, stays unknown.
class DepthRegistration {
 public:
  /// The camera must have a depth camera of its own.
  explicit DepthRegistration(const RgbdCamera& camera);

  /// 32FC1 of the colour camera's size from 32FC1 of the depth camera's; 0 = unknown in both.
  [[nodiscard]] cv::Mat operator()(const cv::Mat& depth_m) const;

 private:
  /// A depth pixel in the colour image; inverse_depth is 0 where it is unknown or not in view.
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
  float longest_side_px_;              ///< of a triangle in the colour image
  std::vector<Eigen::Vector2f> rays_;  ///< of each depth pixel, x/z and y/z
};

/// The camera of frames that have been registered (and shifted) on the way in: without a depth camera of its
/// own.
RgbdCamera registered(RgbdCamera camera);

/// The camera of an image enlarged or made smaller to `width` pixels.
PinholeCamera resized(const PinholeCamera& camera, int width);

}  // namespace kinloop
