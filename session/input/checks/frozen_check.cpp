#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "session/input/checks/checks.hpp"
#include "session/input/measures/small_images.hpp"

namespace kinloop {
namespace {

/// The pixels of a grid. In two images of different moments noise alone makes some of a few hundred differ.
/// Those of depth are read by sampled_depth, too: that they are cached by then saves half of the time.
template <class Pixel>
std::vector<Pixel> grid_of(const cv::Mat& image) {
  constexpr int kColumns = 20;
  const int step = std::max(1, image.cols / kColumns);
  std::vector<Pixel> pixels;
  for (int y = step / 4; y < image.rows; y += step) {
    const auto* row = image.ptr<Pixel>(y);
    for (int x = step / 4; x < image.cols; x += step) pixels.push_back(row[x]);
  }
  return pixels;
}

std::optional<InputWarning> warning_of(InputFault fault, const FrozenTimes& times, int64_t first_ns) {
  const auto all = times.intervals();
  if (all.empty()) return std::nullopt;
  double total_s = 0;
  for (const auto& one : all) total_s += one.duration_s();
  const auto longest = *std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.duration_s() < b.duration_s(); });
  const bool depth = fault == InputFault::kFrozenDepth;
  const std::string count = all.size() == 1 ? "once" : fmt::format("{} times", all.size());
  return InputWarning{
      fault,
      fmt::format("{} froze {} while {} went on, for {:.1f} s in all (longest: {:.1f} s to {:.1f} s)",
                  depth ? "depth" : "colour", count, depth ? "colour" : "depth", total_s,
                  to_seconds(longest.from_ns - first_ns), to_seconds(longest.to_ns - first_ns)),
      "record again: the camera or its driver was overloaded; poses of these times are not to be trusted",
      false};
}

}  // namespace

bool FrozenTimes::Interval::is_long() const {
  constexpr double kLong_s = 0.5;
  constexpr int kFewest = 3;
  return duration_s() >= kLong_s && frames >= kFewest;
}

void FrozenTimes::add(int64_t from_ns, int64_t to_ns, bool frozen) {
  if (frozen) {
    if (current_.frames++ == 0) current_.from_ns = from_ns;
    current_.to_ns = to_ns;
    return;
  }
  if (current_.is_long()) past_.push_back(current_);
  current_ = {};
}

std::vector<FrozenTimes::Interval> FrozenTimes::intervals() const {
  auto all = past_;
  if (current_.is_long()) all.push_back(current_);
  return all;
}

void FrozenCheck::observe(const Frame& frame) {
  auto gray = grid_of<uint8_t>(gray_of(frame));
  auto depth_m = grid_of<float>(frame.depth_m);
  if (first_ns_) {
    const bool same_color = gray == gray_, same_depth = depth_m == depth_m_;
    if (same_color && same_depth) return;  // the frame repeats, as recorders of two rates do
    const bool any_depth = std::any_of(depth_m.begin(), depth_m.end(), [](float z_m) { return z_m > 0; });
    frozen_depth_.add(stamp_ns_, frame.stamp_ns, same_depth && any_depth && !same_color);
    frozen_color_.add(stamp_ns_, frame.stamp_ns, same_color && !same_depth);
  } else {
    first_ns_ = frame.stamp_ns;
  }
  gray_ = std::move(gray);
  depth_m_ = std::move(depth_m);
  stamp_ns_ = frame.stamp_ns;
}

std::optional<InputWarning> FrozenCheck::depth() const {
  return warning_of(InputFault::kFrozenDepth, frozen_depth_, first_ns_.value_or(0));
}

std::optional<InputWarning> FrozenCheck::color() const {
  return warning_of(InputFault::kFrozenColor, frozen_color_, first_ns_.value_or(0));
}

}  // namespace kinloop
