#include "drivers/images/rational_lens.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace kinloop {

RationalUndistortion::RationalUndistortion(const RationalCamera& camera) {
  const PinholeCamera& c = camera.pinhole;
  const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  cv::initUndistortRectifyMap(K, camera.distortion, cv::noArray(), K, {c.width, c.height}, CV_32FC1, map_x_,
                              map_y_);
}

cv::Mat RationalUndistortion::color(const cv::Mat& image) const {
  cv::Mat result;
  cv::remap(image, result, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return result;
}

cv::Mat RationalUndistortion::depth(const cv::Mat& depth_m) const {
  cv::Mat result;
  cv::remap(depth_m, result, map_x_, map_y_, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return result;
}

}  // namespace kinloop
