#pragma once
// In: images of a lens with the rational model of OpenCV (k1 to k6, p1, p2). Out: images of an ideal pinhole.

#include <array>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// A camera with the rational model; the distortion of `pinhole` itself is zero.
struct RationalCamera {
  PinholeCamera pinhole;
  std::array<double, 8> distortion{};  ///< k1 k2 p1 p2 k3 k4 k5 k6
};

/// Undistorts images of one camera to its pinhole.
class RationalUndistortion {
 public:
  explicit RationalUndistortion(const RationalCamera& camera);

  /// Interpolates linearly; pixels without a source are black.
  [[nodiscard]] cv::Mat color(const cv::Mat& image) const;

  /// Takes the nearest pixel; pixels without a source are unknown.
  [[nodiscard]] cv::Mat depth(const cv::Mat& depth_m) const;

 private:
  cv::Mat map_x_, map_y_;  ///< source pixel of each pixel
};

}  // namespace kinloop
