#include "drivers/kinect2/kinect2_source.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_FREENECT2

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/kinect2/kinect2_factory.hpp"
#include "drivers/kinect2/kinect2_stream.hpp"
#include "drivers/live/reconnection.hpp"

namespace kinloop {
namespace {

constexpr std::chrono::milliseconds kFrameTimeout(1000);  ///< thirty frames without data: the camera is gone

/// Width of the stored colour image: as requested, or twice the depth camera's if it is resampled to that
/// view.
int received_width(const KinectOptions& options) {
  constexpr int kHalf = 960;
  if (options.width != kKinect2ColorWidth && options.width != kHalf && options.width != kKinect2DepthWidth) {
    throw UsageError(fmt::format("kinect.width={}: expected 1920, 960 or 512", options.width));
  }
  return options.width == kKinect2DepthWidth ? kHalf : options.width;
}

/// An undistorted camera with the depth camera's field of view at the colour camera's position.
PinholeCamera view_of_depth_camera(const PinholeCamera& depth) {
  PinholeCamera view = depth;
  view.lens = {};
  return view;
}

/// For each pixel of `to` the pixel of `from` in the same direction.
cv::Mat map_between(const PinholeCamera& to, const PinholeCamera& from) {
  cv::Mat map(to.height, to.width, CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector3d ray = to.unproject(to.undistort(Eigen::Vector2d(x, y)), 1);
      const Eigen::Vector2f pixel = from.distort(from.project(ray)).cast<float>();
      map.at<cv::Vec2f>(y, x) = {pixel.x(), pixel.y()};
    }
  }
  return map;
}

}  // namespace

Kinect2Source::Kinect2Source(std::function<Kinect2Handle()> open, const KinectOptions& options,
                             const std::optional<RgbdCamera>& calibration, Kinect2Frames frames)
    : open_(std::move(open)),
      options_(options),
      listener_(frames_, received_width(options), frames == Kinect2Frames::kSeparate),
      handle_(open_()) {
  info_.name = "kinect2";
  info_.live = true;
  info_.serial = handle_.device->getSerialNumber();
  RgbdCamera rig = calibration ? *calibration
                               : factory_camera(handle_.device->getColorCameraParams(),
                                                handle_.device->getIrCameraParams());
  if (!rig.depth) {
    throw InputError(
        "kinect2: the --camera file has no 'depth' camera; create one with kinloop calibrate extrinsics, or "
        "omit --camera to use the factory calibration");
  }
  rig.sensor.set_by_source(DepthSensorModel::kKinect2);
  rig.color = resized(rig.color, received_width(options));
  if (options.width == kKinect2DepthWidth) {
    const PinholeCamera view = view_of_depth_camera(*rig.depth);
    color_remap_ = map_between(view, rig.color);
    rig.color = view;
  }
  if (frames == Kinect2Frames::kSeparate) {
    camera_ = rig;
  } else {
    shift_m_ = rig.depth_shift_m;
    registration_.emplace(rig);
    camera_.color = rig.color;
    camera_.sensor = rig.sensor;
  }
  start_kinect2(handle_, listener_, options_);
}

Kinect2Source::~Kinect2Source() {
  close_kinect2(handle_);
}

void Kinect2Source::reopen() {
  handle_ = open_();
  listener_.restart_clock();
  start_kinect2(handle_, listener_, options_);
}

std::optional<Frame> Kinect2Source::next() {
  auto frame =
      next_or_reconnect(frames_, {info_.name, kFrameTimeout, options_.reconnect_s,
                                  [this] { close_kinect2(handle_); }, [this] { reopen(); }, options_.stop});
  if (!frame) return frame;
  if (shift_m_ != 0) cv::add(frame->depth_m, shift_m_, frame->depth_m, frame->depth_m > 0);
  if (registration_) frame->depth_m = (*registration_)(frame->depth_m);
  if (!color_remap_.empty()) {
    cv::Mat color;
    cv::remap(frame->color.bgr(), color, color_remap_, cv::noArray(), cv::INTER_LINEAR);
    frame->color = color;
  }
  return frame;
}

SkippedFrames Kinect2Source::skipped() const {
  auto skipped = to_skipped_frames(frames_.counts());
  skipped.add({"image", "marked as faulty by the driver"}, listener_.faulty());
  return skipped;
}

bool kinect2_available() {
  return true;
}

std::unique_ptr<FrameSource> open_kinect2(const KinectOptions& options,
                                          const std::optional<RgbdCamera>& calibration) {
  return std::make_unique<Kinect2Source>([options] { return open_kinect2_device(options); }, options,
                                         calibration, options.frames);
}

}  // namespace kinloop

#else

namespace kinloop {

bool kinect2_available() {
  return false;
}

std::unique_ptr<FrameSource> open_kinect2(const KinectOptions&, const std::optional<RgbdCamera>&) {
  throw UsageError(
      "kinect2: not supported by this build; install libfreenect2 and rebuild (docs/cameras.md)");
}

}  // namespace kinloop

#endif
