#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/time.hpp"
#include "session/input/checks/checks.hpp"
#include "session/input/measures/small_images.hpp"

namespace kinloop {
namespace {

constexpr size_t kMostFrames = 20000;  // eleven minutes decide

constexpr int kWidth_px = 40, kHeight_px = 30;

/// The mean brightness of each part of the image, 8UC1.
cv::Mat small_gray(const Frame& frame) {
  cv::Mat small;
  cv::resize(frame.octaves.empty() ? gray_of(frame) : frame.octaves.back(), small, {kWidth_px, kHeight_px}, 0,
             0, cv::INTER_AREA);
  return small;
}

/// Inverse depth at every n-th pixel, 32FC1, 0 = unknown.
cv::Mat small_inverse_depth(const cv::Mat& depth_m) {
  cv::Mat small = sampled_depth(depth_m, {kWidth_px, kHeight_px});
  for (auto* value = small.ptr<float>(); value != small.ptr<float>() + small.total(); ++value)
    *value = *value > 0 ? 1 / *value : 0;
  return small;
}

/// Mean change of brightness, without that of the exposure. In whole numbers, whose sums are vectorised.
float color_motion(const cv::Mat& before, const cv::Mat& now) {
  constexpr int kPixels = kWidth_px * kHeight_px;
  int sum = 0, change = 0;
  for (int i = 0; i < kPixels; ++i) sum += now.data[i] - before.data[i];
  for (int i = 0; i < kPixels; ++i) change += std::abs(kPixels * (now.data[i] - before.data[i]) - sum);
  return static_cast<float>(change) / (static_cast<float>(kPixels) * kPixels);
}

/// Mean change of inverse depth where both are known.
float depth_motion(const cv::Mat& before, const cv::Mat& now) {
  const auto *a = before.ptr<float>(), *b = now.ptr<float>();
  float sum = 0;
  int count = 0;
  for (size_t i = 0; i < now.total(); ++i) {
    if (a[i] == 0 || b[i] == 0) continue;
    sum += std::abs(a[i] - b[i]);
    ++count;
  }
  return count == 0 ? 0 : sum / static_cast<float>(count);
}

/// The logarithm, without slow changes: which motions are strong for their time.
std::vector<float> relative_motion(std::vector<float> motion) {
  constexpr float kSmallest = 0.1F;
  constexpr int kSlow = 30;  // frames before and after
  const float floor = std::max(kSmallest * median(motion), 1e-9F);
  for (float& value : motion) value = std::log(std::max(value, floor));
  std::vector<double> sums = {0};
  for (const float value : motion) sums.push_back(sums.back() + static_cast<double>(value));
  const auto count = static_cast<int>(motion.size());
  for (int i = 0; i < count; ++i) {
    const int from = std::max(0, i - kSlow), to = std::min(count, i + kSlow + 1);
    const double mean = (sums[static_cast<size_t>(to)] - sums[static_cast<size_t>(from)]) / (to - from);
    motion[static_cast<size_t>(i)] -= static_cast<float>(mean);
  }
  return motion;
}

/// Correlation of colour at frame i with depth at frame i + lag.
double correlation(const std::vector<float>& color, const std::vector<float>& depth, int lag) {
  const size_t shift = static_cast<size_t>(std::abs(lag)), count = color.size() - shift;
  const float* a = color.data() + (lag < 0 ? shift : 0);
  const float* b = depth.data() + (lag > 0 ? shift : 0);
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < count; ++i) {
    aa += static_cast<double>(a[i] * a[i]);
    bb += static_cast<double>(b[i] * b[i]);
    ab += static_cast<double>(a[i] * b[i]);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

/// Fisher's transformation of a correlation over its standard deviation, which few frames make large.
double score(double correlation, int frames) {
  constexpr double kMost = 0.99;
  return std::atanh(std::clamp(correlation, -kMost, kMost)) * std::sqrt(static_cast<double>(frames));
}

/// Whether no other lag fits as well. Motion that repeats itself, as that of a camera which follows a path of
/// simple curves, has other lags that come near.
bool stands_out(const MotionLag& lag) {
  constexpr double kHigh = 10, kOverOthers = 1.2, kEnough = 9, kFarOverOthers = 1.8;
  return (lag.score > kHigh && lag.score > kOverOthers * lag.elsewhere) ||
         (lag.score > kEnough && lag.score > kFarOverOthers * lag.elsewhere);
}

/// A unit of time that is read as another one.
struct UnitMistake {
  double rate_ratio;  ///< of the rate in the stamps to the real one
  const char* text;
};

constexpr std::array<UnitMistake, 6> kUnitMistakes = {{{1e-3, "milliseconds are read as seconds"},
                                                       {1e-6, "microseconds are read as seconds"},
                                                       {1e-9, "nanoseconds are read as seconds"},
                                                       {1e3, "seconds are read as milliseconds"},
                                                       {1e6, "seconds are read as microseconds"},
                                                       {1e9, "seconds are read as nanoseconds"}}};

}  // namespace

std::optional<MotionLag> motion_lag(std::vector<float> color, std::vector<float> depth, int max_lag) {
  constexpr int kNear = 2, kPeak = 8;
  constexpr int kFewest = 60;
  require(color.size() == depth.size(), "motion_lag: colour and depth differ in length");
  const int count = static_cast<int>(color.size());
  max_lag = std::min(max_lag, count - kFewest);
  if (max_lag <= kNear) return std::nullopt;
  color = relative_motion(std::move(color));
  depth = relative_motion(std::move(depth));
  MotionLag found;
  std::vector<double> scores;
  for (int lag = -max_lag; lag <= max_lag; ++lag) {
    const double here = correlation(color, depth, lag);
    scores.push_back(score(here, count - std::abs(lag)));
    if (std::abs(lag) <= kNear) found.without_lag = std::max(found.without_lag, here);
    if (scores.back() <= found.score) continue;
    found.frames = lag, found.correlation = here, found.score = scores.back();
  }
  for (int i = 0; i <= 2 * max_lag; ++i) {
    const int lag = i - max_lag;
    if (std::abs(lag - found.frames) > kPeak)
      found.elsewhere = std::max(found.elsewhere, scores[static_cast<size_t>(i)]);
  }
  return found;
}

void ClockCheck::observe(const Frame& frame) {
  if (intervals_s_.size() >= kMostFrames) return;
  if (last_ns_) intervals_s_.push_back(to_seconds(frame.stamp_ns - *last_ns_));
  last_ns_ = frame.stamp_ns;
  add_motion(frame);
}

void ClockCheck::add_motion(const Frame& frame) {
  cv::Mat gray = small_gray(frame), inverse_depth = small_inverse_depth(frame.depth_m);
  if (!gray_.empty()) {
    color_motion_.push_back(color_motion(gray_, gray));
    depth_motion_.push_back(depth_motion(inverse_depth_, inverse_depth));
  }
  gray_ = std::move(gray);
  inverse_depth_ = std::move(inverse_depth);
}

double ClockCheck::median_interval_s() const {
  return median(intervals_s_);
}

std::optional<InputWarning> ClockCheck::stamps() const {
  constexpr size_t kFewest = 8;
  constexpr double kSameUnit = 4, kFar = 10;
  const double interval_s = median_interval_s();
  if (intervals_s_.size() < kFewest || !(fps_ > 0) || !(interval_s > 0)) return std::nullopt;
  const double ratio = 1 / (interval_s * fps_);
  const std::string evidence =
      fmt::format("the stamps give {:.3g} frames per second where the camera has {:g}", 1 / interval_s, fps_);
  for (const auto& [rate_ratio, text] : kUnitMistakes) {
    const double off = ratio / rate_ratio;
    if (std::max(off, 1 / off) < kSameUnit)
      return InputWarning{InputFault::kStamps, fmt::format("{}, as if {}", evidence, text),
                          fmt::format("multiply all stamps by {:g}", rate_ratio), false};
  }
  if (std::max(ratio, 1 / ratio) < kFar) return std::nullopt;
  return InputWarning{InputFault::kStamps, evidence,
                      "correct fps in camera.yaml, or the stamps if the rate is right", false};
}

std::optional<InputWarning> ClockCheck::depth_clock() const {
  constexpr double kMaxLag_s = 5;  // the limit of --depth-offset
  constexpr double kMinLag_s = 0.2;
  constexpr double kClear = 0.5, kOverAsItIs = 0.25;
  const double interval_s = median_interval_s();
  if (!(interval_s > 0)) return std::nullopt;
  const auto max_lag =
      static_cast<int>(std::min(kMaxLag_s / interval_s, static_cast<double>(color_motion_.size())));
  const auto lag = motion_lag(color_motion_, depth_motion_, max_lag);
  if (!lag) return std::nullopt;
  const double lag_s = lag->frames * interval_s;
  const bool clear =
      lag->correlation > kClear && lag->correlation > lag->without_lag + kOverAsItIs && stands_out(*lag);
  if (!clear || std::abs(lag_s) < kMinLag_s) return std::nullopt;
  return InputWarning{
      InputFault::kDepthClock,
      fmt::format(
          "depth shows the motion of colour {:.2f} s {} (correlation {:.2f} there, {:.2f} as stamped)",
          std::abs(lag_s), lag_s > 0 ? "later" : "earlier", lag->correlation, lag->without_lag),
      fmt::format("the two streams have different clocks: add {:+.2f} s to the stamps of depth "
                  "(--depth-offset {:.2f})",
                  -lag_s, -lag_s),
      false};
}

}  // namespace kinloop
