#include "session/source/shifted_depth_source.hpp"

#include <cmath>
#include <utility>

#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

/// How many images of one kind may come while the other one is awaited.
size_t waiting_images(double offset_s) {
  constexpr double kMaxRate_hz = 120;
  constexpr size_t kOthers = 30;
  return kOthers + static_cast<size_t>(std::abs(offset_s) * kMaxRate_hz);
}

}  // namespace

ShiftedDepthSource::ShiftedDepthSource(std::unique_ptr<FrameSource> source, double offset_s)
    : ForwardingSource(std::move(source)),
      offset_ns_(to_ns(offset_s)),
      pairer_(kMaxAssociationNs, waiting_images(offset_s)) {
  require(std::abs(offset_s) <= kMaxOffset_s, "ShiftedDepthSource: the offset is beyond the limit");
}

std::optional<Frame> ShiftedDepthSource::next() {
  while (true) {
    if (auto frame = pairer_.next()) return frame;
    if (finished_) return std::nullopt;
    if (auto frame = source().next()) {
      add(*std::move(frame));
    } else {
      finished_ = true;
      pairer_.finish();
    }
  }
}

void ShiftedDepthSource::add(Frame frame) {
  pairer_.add_depth(frame.depth_stamp_or_color_ns() + offset_ns_, std::move(frame.depth_m),
                    std::move(frame.infrared));
  pairer_.add_color(frame.stamp_ns, std::move(frame.color), std::move(frame.mask));
}

SkippedFrames ShiftedDepthSource::skipped() const {
  auto all = ForwardingSource::skipped();
  all.add({"image", "no image of the other camera within 0.02 s after --depth-offset"}, pairer_.unpaired());
  all.add({"image", "its timestamp does not increase"}, pairer_.out_of_order());
  return all;
}

}  // namespace kinloop
