#pragma once
// In: a source whose depth has another clock than colour, and by how much. Out: its images, paired anew.

#include <memory>

#include "drivers/live/frame_pairer.hpp"
#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// Adds `offset_s` to the stamps of depth and pairs each colour image with the depth image that is then
/// nearest. As many images as come in that time wait in memory; those without a partner are skipped and
/// counted.
class ShiftedDepthSource : public ForwardingSource {
 public:
  static constexpr double kMaxOffset_s = 5;  ///< of either sign

  /// Throws std::logic_error for an offset beyond the limit.
  ShiftedDepthSource(std::unique_ptr<FrameSource> source, double offset_s);

  std::optional<Frame> next() override;
  [[nodiscard]] SkippedFrames skipped() const override;

 private:
  void add(Frame frame);

  int64_t offset_ns_;
  FramePairer pairer_;
  bool finished_ = false;
};

}  // namespace kinloop
