#pragma once
// Whether one of the two streams hangs: its image repeats, to the last bit, while the other one goes on.

#include <cstdint>
#include <optional>
#include <vector>

#include "kinloop/core/time.hpp"
#include "kinloop/sensor/frame.hpp"
#include "session/input/checks/input_warning.hpp"

namespace kinloop {

/// The times at which one stream hung for half a second or longer, and at least three frames.
class FrozenTimes {
 public:
  /// Adds the interval up to a frame; `frozen` is whether its image repeats that of the frame before.
  void add(int64_t from_ns, int64_t to_ns, bool frozen);

  struct Interval {
    int64_t from_ns = 0, to_ns = 0;
    int frames = 0;

    [[nodiscard]] double duration_s() const { return to_seconds(to_ns - from_ns); }
    [[nodiscard]] bool is_long() const;
  };

  [[nodiscard]] std::vector<Interval> intervals() const;

 private:
  std::vector<Interval> past_;  // the long ones
  Interval current_;
};

/// Compares a grid of pixels of each frame with those of the previous frame.
class FrozenCheck {
 public:
  /// Frames must be in order of time.
  void observe(const Frame& frame);

  [[nodiscard]] std::optional<InputWarning> depth() const;
  [[nodiscard]] std::optional<InputWarning> color() const;

 private:
  std::vector<uint8_t> gray_;  // of the previous frame
  std::vector<float> depth_m_;
  std::optional<int64_t> first_ns_;
  int64_t stamp_ns_ = 0;
  FrozenTimes frozen_depth_, frozen_color_;
};

}  // namespace kinloop
