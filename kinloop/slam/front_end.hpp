#pragma once
// In: a frame as the source gave it. Out: what can be computed from it alone.

#include "kinloop/features/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"
#include "kinloop/tracking/frame.hpp"

namespace kinloop {

/// A value without state between frames: it may run ahead of tracking on another thread.
class FrontEnd {
 public:
  /// `first_frame` is added to the ids of the frames: those of maps that were loaded come before it.
  FrontEnd(const PinholeCamera& camera, const FeatureOptions& options, uint32_t first_frame = 0)
      : camera_(camera), options_(options), first_frame_(first_frame) {}

  /// Keypoints with descriptors and depth. Throws std::logic_error unless both images have the camera's size
  /// and the types of RgbdFrame.
  [[nodiscard]] PreparedFrame prepare(const RgbdFrame& frame) const;

  [[nodiscard]] uint32_t first_frame() const { return first_frame_; }

 private:
  PinholeCamera camera_;
  FeatureOptions options_;
  uint32_t first_frame_;
};

}  // namespace kinloop
