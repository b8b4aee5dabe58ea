#ifdef KINLOOP_WITH_FREENECT2

#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "drivers/kinect2/kinect2_stream.hpp"

namespace kinloop {
namespace {

using DeviceFrame = libfreenect2::Frame;

constexpr double kMillimetresPerMetre = 1000;

/// Wraps the frame's memory as an image.
cv::Mat image_of(const DeviceFrame& frame, int type) {
  return {static_cast<int>(frame.height), static_cast<int>(frame.width), type, frame.data};
}

}  // namespace

bool Kinect2Listener::onNewFrame(DeviceFrame::Type type, DeviceFrame* frame) {
  constexpr bool kTakesOwnership = false;  // return value: libfreenect2 keeps the frame
  if (frame->status != 0) {
    ++faulty_;
    return kTakesOwnership;
  }
  const int64_t stamp = clock_.stamp_ns(frame->timestamp);
  if (type == DeviceFrame::Color) on_color(stamp, *frame);
  if (type == DeviceFrame::Ir) on_infrared(*frame);
  if (type == DeviceFrame::Depth) on_depth(stamp, *frame);
  return kTakesOwnership;
}

void Kinect2Listener::on_color(int64_t stamp_ns, const DeviceFrame& frame) {
  cv::Mat color;
  cv::cvtColor(image_of(frame, CV_8UC4), color,
               frame.format == DeviceFrame::RGBX ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
  if (color_width_ < color.cols) {
    const int height =
        static_cast<int>(std::lround(static_cast<double>(color.rows) * color_width_ / color.cols));
    cv::resize(color, color, {color_width_, height}, 0, 0, cv::INTER_AREA);
  }
  cv::flip(color, color, 1);
  frames_.add_color(stamp_ns, color);
}

void Kinect2Listener::on_infrared(const DeviceFrame& frame) {
  if (!with_infrared_) return;
  cv::Mat infrared;
  image_of(frame, CV_32FC1).convertTo(infrared, CV_16UC1);
  cv::flip(infrared, infrared, 1);
  infrared_ = infrared;
}

void Kinect2Listener::on_depth(int64_t stamp_ns, const DeviceFrame& frame) {
  cv::Mat depth_m;
  image_of(frame, CV_32FC1).convertTo(depth_m, CV_32FC1, 1 / kMillimetresPerMetre);
  depth_m.setTo(0, ~(depth_m > 0));  // includes NaN
  cv::flip(depth_m, depth_m, 1);
  frames_.add_depth(stamp_ns, depth_m, std::exchange(infrared_, {}));
}

}  // namespace kinloop

#endif
