#include "kinloop/features/extraction/surf.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

#ifdef KINLOOP_WITH_DLIB
#include <dlib/array2d.h>
#include <dlib/image_keypoint.h>
#endif

#include "kinloop/core/errors.hpp"

namespace kinloop {

#ifdef KINLOOP_WITH_DLIB

bool surf_available() {
  return true;
}

SurfFeatures detect_surf(const cv::Mat& gray, int count) {
  constexpr int kDimensions = 64;
  constexpr double kThreshold = 3.0;  // on the determinant of the Hessian; low, so that `count` decides
  constexpr double kSigmaOfScaleOne = 1.2;
  dlib::array2d<unsigned char> image(gray.rows, gray.cols);
  for (int y = 0; y < gray.rows; ++y) {
    std::memcpy(&image[y][0], gray.ptr(y), static_cast<size_t>(gray.cols));
  }
  const auto points = dlib::get_surf_points(image, count, kThreshold);
  SurfFeatures result;
  result.descriptors.create(static_cast<int>(points.size()), kDimensions, CV_32FC1);
  for (size_t i = 0; i < points.size(); ++i) {
    const auto& point = points[i];
    const cv::Point2f at(static_cast<float>(point.p.center.x()), static_cast<float>(point.p.center.y()));
    const auto size = static_cast<float>(2 * kSigmaOfScaleOne * point.p.scale);
    const auto angle_deg = static_cast<float>(point.angle * 180 / std::numbers::pi);
    result.keypoints.emplace_back(at, size, angle_deg, static_cast<float>(point.p.score), 0);
    for (int d = 0; d < kDimensions; ++d) {
      result.descriptors.at<float>(static_cast<int>(i), d) = static_cast<float>(point.des(d));
    }
  }
  return result;
}

#else

bool surf_available() {
  return false;
}

SurfFeatures detect_surf(const cv::Mat&, int) {
  throw UsageError("SURF: this build has no dlib; install libdlib-dev and rebuild kinloop");
}

#endif

}  // namespace kinloop
