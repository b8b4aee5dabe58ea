#include "kinloop/tracking/front_end.hpp"

#include "kinloop/core/errors.hpp"
#include "kinloop/features/extractor.hpp"

namespace kinloop {

std::shared_ptr<const Features> FrontEnd::features(const PreparedFrame& frame) const {
  Features features = extract_features(frame.gray, frame.depth_m, sensor_, options_);
  features.depth_stamp_difference_s = depth_stamp_difference_s(frame);
  return std::make_shared<const Features>(std::move(features));
}

PreparedFrame FrontEnd::prepare(const RgbdFrame& frame) const {
  const cv::Size size(sensor_.camera.width, sensor_.camera.height);
  require(frame.color.size() == size, "prepare: color image must be of the camera's size");
  require(frame.depth_m.type() == CV_32FC1 && frame.depth_m.size() == size,
          "prepare: depth image must be 32FC1 in metres, of the camera's size");
  const Stopwatch watch;
  PreparedFrame prepared;
  prepared.id = FrameId{first_frame_ + frame.id.value};
  prepared.stamp_ns = frame.stamp_ns;
  prepared.depth_stamp_ns = frame.depth_stamp_ns;
  prepared.color = frame.color;
  prepared.depth_m = frame.depth_m;
  prepared.gray = frame.color.gray();
  prepared.octaves = make_octaves(prepared.gray, kOctaves);
  prepared.preparing = watch.elapsed();
  return prepared;
}

}  // namespace kinloop
