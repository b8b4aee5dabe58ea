#ifdef KINLOOP_WITH_FREENECT2

#include "drivers/kinect2/kinect2_factory.hpp"

#include <libfreenect2/registration.h>
#include <opencv2/calib3d.hpp>

#include "drivers/kinect2/kinect2_device.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr double kMillimetresPerMetre = 1000;

/// The camera of the mirrored image.
PinholeCamera mirrored(PinholeCamera camera) {
  camera.cx = camera.width - 1 - camera.cx;
  camera.lens.p2 = -camera.lens.p2;
  return camera;
}

PinholeCamera color_lens(const libfreenect2::Freenect2Device::ColorCameraParams& p) {
  PinholeCamera camera;
  camera.width = kKinect2ColorWidth, camera.height = kKinect2ColorHeight;
  camera.fx = p.fx, camera.fy = p.fy, camera.cx = p.cx, camera.cy = p.cy;
  return camera;
}

PinholeCamera depth_lens(const libfreenect2::Freenect2Device::IrCameraParams& p) {
  PinholeCamera camera;
  camera.width = kKinect2DepthWidth, camera.height = kKinect2DepthHeight;
  camera.fx = p.fx, camera.fy = p.fy, camera.cx = p.cx, camera.cy = p.cy;
  camera.lens = {LensModel::kBrownConrady, p.k1, p.k2, p.p1, p.p2, p.k3};
  return camera;
}

}  // namespace

RgbdCamera factory_camera(const libfreenect2::Freenect2Device::ColorCameraParams& color,
                          const libfreenect2::Freenect2Device::IrCameraParams& infrared) {
  const libfreenect2::Registration mapping(infrared, color);
  const PinholeCamera depth = depth_lens(infrared);
  // Where libfreenect2 maps points of the depth camera into the colour image, over the image and the depth
  // range.
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  constexpr int kStep = 32;
  for (int y = kStep / 2; y < kKinect2DepthHeight; y += kStep) {
    for (int x = kStep / 2; x < kKinect2DepthWidth; x += kStep) {
      for (const double z : {0.7, 1.5, 4.0}) {
        float u = 0, v = 0;
        // The mapping expects distorted pixels.
        mapping.apply(x, y, static_cast<float>(z * kMillimetresPerMetre), u, v);
        const bool inside = u >= 0 && v >= 0 && u < kKinect2ColorWidth && v < kKinect2ColorHeight;
        if (!inside) continue;
        const Eigen::Vector3d p = depth.unproject(depth.undistort(Eigen::Vector2d(x, y)), z);
        points.emplace_back(p.x(), p.y(), p.z());
        pixels.emplace_back(static_cast<double>(u), static_cast<double>(v));
      }
    }
  }
  constexpr size_t kMinCount = 20;
  if (points.size() < kMinCount) {
    throw InputError("kinect2: the device's factory calibration cannot be read; give --camera FILE");
  }
  const PinholeCamera lens = color_lens(color);
  const cv::Matx33d K(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  cv::solvePnP(points, pixels, K, cv::noArray(), rotation, translation);
  // Undoes the mirroring: x changes its sign, and with it the rotations about y and z.
  RgbdCamera camera;
  camera.color = mirrored(lens);
  camera.depth = mirrored(depth);
  camera.T_color_depth = {exp_so3({rotation[0], -rotation[1], -rotation[2]}),
                          {-translation[0], translation[1], translation[2]}};
  return camera;
}

}  // namespace kinloop

#endif
