#pragma once
// In: a source, and how many of its frames to use. Out: every n-th frame, as from a slower camera.

#include <memory>

#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// Delivers the first frame of a source and each n-th after it, with consecutive ids and 1/n of the rate.
/// Frames between them are not read if the source is a PassableSource.
class ThinnedSource : public ForwardingSource {
 public:
  static constexpr int kMaxStep = 100'000;

  /// Throws std::logic_error for a null pointer, or a step below 1 or above the limit.
  ThinnedSource(std::unique_ptr<FrameSource> source, int step);

  std::optional<Frame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }

 private:
  /// Passes over one frame; false at the end.
  bool pass_over();

  int step_;
  RgbdCamera camera_;
  SourceInfo info_;
  uint32_t next_id_ = 0;
};

}  // namespace kinloop
