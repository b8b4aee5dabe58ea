#include "kinloop/tracking/front_end.hpp"

#include "kinloop/core/errors.hpp"
#include "kinloop/features/extractor.hpp"
#include "kinloop/features/image_octaves.hpp"

namespace kinloop {

std::shared_ptr<const Features> FrontEnd::features(const Frame& frame) const {
  Features features = extract_features(frame.gray, frame.depth_m, sensor_, options_);
  features.depth_stamp_difference_s = depth_stamp_difference_s(frame);
  return std::make_shared<const Features>(std::move(features));
}

Frame FrontEnd::prepare(Frame frame) const {
  const cv::Size size(sensor_.camera.width, sensor_.camera.height);
  require(frame.color.size() == size, "prepare: color image must be of the camera's size");
  require(frame.depth_m.type() == CV_32FC1 && frame.depth_m.size() == size,
          "prepare: depth image must be 32FC1 in metres, of the camera's size");
  const Stopwatch watch;
  frame.id = FrameId{first_frame_ + frame.id.value};
  frame.gray = frame.color.gray();
  frame.octaves = make_octaves(frame.gray, kOctaves);
  frame.surfaces = std::make_shared<const SurfaceGrid>(make_surface_grid(surface_camera_, frame.depth_m));
  frame.time.preparing = watch.elapsed();
  return frame;
}

}  // namespace kinloop
