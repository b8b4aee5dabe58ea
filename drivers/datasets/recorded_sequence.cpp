#include "drivers/datasets/recorded_sequence.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace kinloop {
namespace {

std::string unit_of_depth(const RecordedSequence& sequence, const RgbdCamera& camera) {
  constexpr double kMillimetres = 1000;
  if (is_metric(sequence.depth_encoding) || camera.depth_scale == 1) return "m";
  if (camera.depth_scale == kMillimetres) return "mm";
  return fmt::format("1/{} m", camera.depth_scale);
}

}  // namespace

std::string describe(const RecordedSequence& sequence, const RgbdCamera& camera) {
  const PinholeCamera& color = camera.color;
  const std::string registration = camera.depth ? fmt::format("depth of {} x {} to be registered,",
                                                              camera.depth->width, camera.depth->height)
                                                : "registered depth";
  const auto masks = std::count_if(sequence.frames.begin(), sequence.frames.end(),
                                   [](const RecordedFrame& frame) { return !frame.mask.empty(); });
  return fmt::format("{}: {} frames, {} x {}, {} in {}{}", sequence.layout, sequence.frames.size(),
                     color.width, color.height, registration, unit_of_depth(sequence, camera),
                     masks > 0 ? fmt::format(", masks of {}", masks) : "");
}

}  // namespace kinloop
