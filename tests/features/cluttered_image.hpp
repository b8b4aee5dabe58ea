#pragma once

#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop::test {

/// Random rectangles of all sizes; the right half is dim, as rooms have dim corners.
inline cv::Mat cluttered_image(uint64_t seed) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(100));
  Random random(seed);
  for (int i = 0; i < 900; ++i) {
    const auto below = [&](uint32_t count) { return static_cast<int>(random.index(count)); };
    const int y = below(480), x = below(640), height = 4 + below(40), width = 4 + below(40);
    cv::rectangle(image, cv::Rect(x, y, width, height), cv::Scalar(random.uniform(0, 255)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  cv::Mat right = image.colRange(320, 640);
  right.convertTo(right, CV_8U, 0.25, 20);
  return image;
}

/// An undistorted camera for images of that size.
inline PinholeCamera ideal_camera() {
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 525;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

}  // namespace kinloop::test
