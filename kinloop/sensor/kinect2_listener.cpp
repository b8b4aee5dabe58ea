#include "kinloop/sensor/kinect2_listener.hpp"

#ifdef KINLOOP_WITH_FREENECT2

#include <opencv2/imgproc.hpp>

namespace kinloop {
namespace {

constexpr double kMillimetresPerMetre = 1000;

}  // namespace

bool Kinect2Listener::onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) {
  if (frame->status != 0) {
    ++faulty_;
    return false;
  }
  const int64_t stamp = clock_.stamp_ns(frame->timestamp);
  const cv::Size size(static_cast<int>(frame->width), static_cast<int>(frame->height));
  if (type == libfreenect2::Frame::Color) {
    const bool rgb = frame->format == libfreenect2::Frame::RGBX;
    cv::Mat color, mirror(size, CV_8UC4, frame->data);
    cv::cvtColor(mirror, color, rgb ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
    if (color_width_ < color.cols) {
      const int height =
          static_cast<int>(std::lround(static_cast<double>(color.rows) * color_width_ / color.cols));
      cv::resize(color, color, {color_width_, height}, 0, 0, cv::INTER_AREA);
    }
    cv::flip(color, color, 1);
    frames_.add_color(stamp, color);
  } else if (type == libfreenect2::Frame::Depth) {
    cv::Mat depth_m;
    cv::Mat(size, CV_32FC1, frame->data).convertTo(depth_m, CV_32FC1, 1 / kMillimetresPerMetre);
    depth_m.setTo(0, ~(depth_m > 0));  // not a number, too
    cv::flip(depth_m, depth_m, 1);
    frames_.add_depth(stamp, depth_m);
  }
  return false;  // libfreenect2 keeps its frame
}

}  // namespace kinloop

#endif
