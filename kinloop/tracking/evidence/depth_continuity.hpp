#pragma once
// Whether depth goes on as the image does. A driver that changes its unit, or a recording joined from two,
// multiplies all depths by a factor from one frame to the next; a stream that hangs repeats its last image.
// No motion of the camera does either, so both are found without a map.

#include <cstdint>
#include <memory>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/time.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// Compares the depth of each frame with that of the previous one.
class DepthContinuity {
 public:
  /// Adds a prepared frame, as measured. `velocity` is that of the camera at the previous frame that was no
  /// repeat; without it, the scale is not checked.
  void observe(const Frame& frame, const std::optional<Velocity>& velocity);

  /// Returns the factor by which the depth of the latest frame is to be multiplied: the one that gives it the
  /// scale of the first frame, or 0 if its depth is an old one or there is none.
  [[nodiscard]] double factor() const;

  /// Returns the stamp of the latest frame with new depth.
  [[nodiscard]] int64_t new_depth_ns() const { return new_depth_ns_; }

  /// Returns for how long there has been no new depth at the latest frame, although there were new images, s.
  [[nodiscard]] double age_s() const { return to_seconds(age_ns_); }

 private:
  [[nodiscard]] bool is_repeat(const Frame& frame) const;
  void compare(const Frame& frame, const std::optional<Velocity>& velocity, int64_t interval_ns);
  [[nodiscard]] std::optional<double> scale_step(const Frame& frame, const Velocity& velocity) const;

  std::shared_ptr<const SurfaceGrid> surfaces_;  // of the previous frame that was no repeat, as measured
  cv::Mat image_;                                // likewise, the smallest octave
  int64_t stamp_ns_ = 0;                         // likewise
  int64_t baseline_ns_ = 0;                      // between that frame and the one before it
  int64_t latest_ns_ = 0;                        // of the previous frame, also of a repeat
  int64_t new_depth_ns_ = 0;                     // stamp of the latest frame with new depth
  int64_t age_ns_ = 0;                           // since then, without the time of repeated images
  double factor_ = 1;
};

}  // namespace kinloop
