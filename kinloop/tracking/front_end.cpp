#include "kinloop/tracking/front_end.hpp"

#include "kinloop/core/errors.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/extraction/image_octaves.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"

namespace kinloop {
namespace {

/// Returns the depth where the mask is not 0.
cv::Mat masked_depth(const cv::Mat& depth_m, const cv::Mat& mask) {
  cv::Mat masked = cv::Mat::zeros(depth_m.size(), depth_m.type());
  depth_m.copyTo(masked, mask);
  return masked;
}

}  // namespace

std::shared_ptr<const Features> FrontEnd::features(const Frame& frame) const {
  Features features =
      extract_features(frame.gray, frame.depth_m, sensor_, options_, used_pixels(frame.ignored));
  features.depth_stamp_difference_s = depth_stamp_difference_s(frame);
  return std::make_shared<const Features>(std::move(features));
}

std::shared_ptr<const SurfaceGrid> FrontEnd::surfaces(const cv::Mat& depth_m) const {
  return std::make_shared<const SurfaceGrid>(make_surface_grid(surface_camera_, depth_m));
}

Frame FrontEnd::prepare(Frame frame) const {
  const cv::Size size(sensor_.camera.width, sensor_.camera.height);
  require(frame.color.size() == size, "prepare: color image must be of the camera's size");
  require(frame.depth_m.type() == CV_32FC1 && frame.depth_m.size() == size,
          "prepare: depth image must be 32FC1 in metres, of the camera's size");
  require(frame.mask.empty() || (frame.mask.type() == CV_8UC1 && frame.mask.size() == size),
          "prepare: the mask must be 8UC1, of the camera's size");
  const Stopwatch watch;
  frame.id = FrameId{first_frame_ + frame.id.value};
  frame.gray = frame.color.gray();
  frame.octaves = make_octaves(frame.gray, kOctaves);
  if (frame.mask.empty()) {
    frame.surfaces = surfaces(frame.depth_m);
  } else {
    const cv::Mat mask = frame.mask;
    frame = ignore(std::move(frame), mask, IgnoreCause::kUser);
  }
  frame.time.preparing = watch.elapsed();
  return frame;
}

cv::Mat depth_at_rest_m(const Frame& frame, const cv::Mat& moved) {
  if (moved.empty()) return frame.depth_m;
  return masked_depth(frame.depth_m, unmarked_pixels(*frame.surfaces->camera, moved, frame.depth_m.size()));
}

Frame FrontEnd::scale_depth(Frame frame, double factor) const {
  frame.depth_m = frame.depth_m * factor;
  frame.surfaces = surfaces(frame.depth_m);
  frame.features = nullptr;
  return frame;
}

Frame FrontEnd::ignore(Frame frame, const cv::Mat& mask, IgnoreCause cause) const {
  frame.ignored = with_cause(frame.ignored, mask, cause);
  frame.depth_m = masked_depth(frame.depth_m, mask);
  frame.features = nullptr;
  if (cause != IgnoreCause::kMoved) frame.surfaces = surfaces(frame.depth_m);
  return frame;
}

}  // namespace kinloop
