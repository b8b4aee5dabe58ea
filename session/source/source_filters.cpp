#include "session/source/source_filters.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/source/passable_source.hpp"
#include "kinloop/sensor/surfaces/mask.hpp"

namespace kinloop {
namespace {

/// How many images of one kind may come while the other one is awaited.
size_t waiting_images(double offset_s) {
  constexpr double kMaxRate_hz = 120;
  constexpr size_t kOthers = 30;
  return kOthers + static_cast<size_t>(std::abs(offset_s) * kMaxRate_hz);
}

/// Throws InputError naming the file and the remedy.
cv::Mat read_mask(const std::filesystem::path& path, const cv::Size& size) {
  const ColorImage image = read_color_image(path);
  if (image.size() != size)
    throw InputError(fmt::format("{}: {} x {} pixels where the colour images have {} x {}", path.string(),
                                 image.size().width, image.size().height, size.width, size.height));
  cv::Mat mask = image.gray() >= 128;  // a JPEG has no pure black
  if (cv::countNonZero(mask) == 0)
    throw InputError(
        fmt::format("{}: all pixels are black, which means to be ignored; what is to be used must be white",
                    path.string()));
  return mask;
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

ThinnedSource::ThinnedSource(std::unique_ptr<FrameSource> source, int step)
    : ForwardingSource(std::move(source)),
      step_(step),
      camera_(ForwardingSource::camera()),
      info_(ForwardingSource::info()) {
  require(step >= 1 && step <= kMaxStep, "ThinnedSource: the step is out of range");
  camera_.fps /= step;
  const auto n = static_cast<size_t>(step);
  info_.frames = (info_.frames + n - 1) / n;
}

std::optional<Frame> ThinnedSource::next() {
  for (int passed_over = next_id_ == 0 ? 0 : step_ - 1; passed_over > 0; --passed_over) {
    if (!pass_over()) return std::nullopt;
  }
  auto frame = source().next();
  if (frame) frame->id = FrameId{next_id_++};
  return frame;
}

bool ThinnedSource::pass_over() {
  auto* passable = dynamic_cast<PassableSource*>(&source());
  return passable != nullptr ? passable->pass_over() : source().next().has_value();
}

MaskedSource::MaskedSource(std::unique_ptr<FrameSource> source, const std::filesystem::path& mask)
    : ForwardingSource(std::move(source)) {
  const PinholeCamera& color = this->source().camera().color;
  mask_ = read_mask(mask, {color.width, color.height});
}

std::optional<Frame> MaskedSource::next() {
  auto frame = source().next();
  if (frame) frame->mask = intersection_of_masks(frame->mask, mask_);
  return frame;
}

PeekedSource::PeekedSource(std::unique_ptr<FrameSource> source, size_t frames)
    : ForwardingSource(std::move(source)) {
  try {
    while (frames_.size() < frames) {
      auto frame = this->source().next();
      if (!frame) break;
      frames_.push_back(*std::move(frame));
    }
  } catch (...) {
    error_ = std::current_exception();
  }
}

std::optional<Frame> PeekedSource::next() {
  if (!frames_.empty()) {
    Frame frame = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  return source().next();
}

}  // namespace kinloop
