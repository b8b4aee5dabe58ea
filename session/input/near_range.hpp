#pragma once
// In: a source, and the limits of depth of its map. Out: limits that suit a near scene, such as an object at
// 0.2 m in front of a RealSense SR300.

#include <deque>
#include <exception>
#include <memory>
#include <optional>

#include "dense/options.hpp"
#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// Reads the first frames ahead, which stay the first ones of the source. An error is thrown in its turn.
class PeekedSource : public ForwardingSource {
 public:
  PeekedSource(std::unique_ptr<FrameSource> source, size_t frames);

  std::optional<Frame> next() override;

  [[nodiscard]] const std::deque<Frame>& first_frames() const { return frames_; }

 private:
  std::deque<Frame> frames_;
  std::exception_ptr error_;  ///< after `frames_`
};

/// Returns a smaller minimum if most depth of the frames lies below that of `limits`: half of the 5 %
/// quantile. nullopt if it does not, or if another usual depth_scale makes it the depth of a room.
std::optional<double> near_minimum_m(const std::deque<Frame>& frames, const DepthLimits& limits,
                                     double depth_scale);

}  // namespace kinloop
