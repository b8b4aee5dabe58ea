#pragma once
// A camera in front of a wall: ground truth for the dense map.

#include <opencv2/core.hpp>

#include "dense/image_store.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop::test {

inline PinholeCamera small_camera() {
  return {.width = 160, .height = 120, .fx = 130, .fy = 131, .cx = 79.5, .cy = 60.2, .lens = {}};
}

/// A lens with as much distortion as that of TUM's freiburg1.
inline PinholeCamera distorted_camera() {
  auto camera = small_camera();
  camera.lens.k1 = 0.26, camera.lens.k2 = -0.95, camera.lens.p1 = -0.005, camera.lens.p2 = 0.003,
  camera.lens.k3 = 1.16;
  return camera;
}

/// Renders the wall world z = `wall_z_m`, in a single colour.
inline RgbdImages view_of_wall(const PinholeCamera& camera, const SE3& T_world_camera, double wall_z_m,
                               const cv::Vec3b& bgr) {
  RgbdImages images{cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(bgr[0], bgr[1], bgr[2])),
                    cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(0))};
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector3d ray = camera.unproject(camera.undistort(Eigen::Vector2d(col, row)), 1);
      const Eigen::Vector3d direction = T_world_camera.R() * ray;
      const double depth_m = (wall_z_m - T_world_camera.translation.z()) / direction.z();
      if (depth_m > 0) images.depth_m.at<float>(row, col) = static_cast<float>(depth_m);
    }
  }
  return images;
}

}  // namespace kinloop::test
