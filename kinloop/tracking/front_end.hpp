#pragma once
// Per-frame processing that depends on the frame alone.

#include "kinloop/features/options.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "kinloop/sensor/surfaces/mask.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// Has no state between frames, so it may run ahead of tracking on another thread.
class FrontEnd {
 public:
  /// `first_frame` is added to the frame ids; frames of loaded maps have lower ids.
  FrontEnd(const Sensor& sensor, const FeatureOptions& options, uint32_t first_frame = 0)
      : sensor_(sensor),
        options_(options),
        first_frame_(first_frame),
        surface_camera_(make_surface_camera(sensor)) {}

  /// Returns the frame with its grey octaves and its surfaces, without features. Throws std::logic_error
  /// unless both images have the camera's size and the types of Frame.
  [[nodiscard]] Frame prepare(Frame frame) const;

  /// Returns a prepared frame without the depth and the features where `mask` (8UC1, of the camera's size) is
  /// 0. It keeps the surfaces of what moved, which tell whether it still does.
  [[nodiscard]] Frame ignore(Frame frame, const cv::Mat& mask, IgnoreCause cause) const;

  /// Returns a prepared frame with all depths multiplied by `factor`; 0 = without depth.
  [[nodiscard]] Frame scale_depth(Frame frame, double factor) const;

  /// Returns keypoints with descriptors and depth.
  [[nodiscard]] std::shared_ptr<const Features> features(const Frame& frame) const;

  [[nodiscard]] uint32_t first_frame() const { return first_frame_; }

 private:
  static constexpr int kOctaves = 4;

  [[nodiscard]] std::shared_ptr<const SurfaceGrid> surfaces(const cv::Mat& depth_m) const;

  Sensor sensor_;
  FeatureOptions options_;
  uint32_t first_frame_;
  std::shared_ptr<const SurfaceCamera> surface_camera_;
};

/// Returns the depth of a prepared frame without the points of its surface grid that are marked in `moved`,
/// see TrackedFrame::moved: what moves would leave a trail in a dense map.
cv::Mat depth_at_rest_m(const Frame& frame, const cv::Mat& moved);

}  // namespace kinloop
