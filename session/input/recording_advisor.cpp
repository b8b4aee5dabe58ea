#include "session/input/recording_advisor.hpp"

#include <algorithm>
#include <utility>

#include "kinloop/core/quantile.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

/// Where a hint begins and, once given, ends. On five simulated rooms and 7-Scenes redkitchen-01 none begins.
struct Threshold {
  double begin = 0, end = 0;
};

/// Radians a second: at 525 px of focal length and an exposure of 1/60 s a blur of 16 px, half of the patch
/// that describes a keypoint. In those recordings 99 % of the frames have less than 1.4.
constexpr Threshold kFast_rad_s{1.8, 1.5};

/// Shares of the pixels. In those recordings 99 % of the frames have more than 0.3.
constexpr Threshold kDepthShare{0.25, 0.33};

/// Structured light and stereo begin at 0.4 to 0.5 m.
constexpr Threshold kNear_m{0.6, 0.7};

/// Grey: cameras raise the gain before that, so that what is left is noise.
constexpr Threshold kDark{90, 105};

/// Shares of the pixels that show nothing any more.
constexpr Threshold kSaturated{0.25, 0.18};

/// Landmarks: in those recordings 99 % of the frames have 100. With 32 % of the poses of a sequence of little
/// contrast in doubt, half of its frames have fewer than 98, and 5 % fewer than 45.
constexpr Threshold kFewInliers{40, 55};

/// Whether a value is above the threshold that holds.
bool is_above(double value, const Threshold& threshold, bool active) {
  return value > (active ? threshold.end : threshold.begin);
}

bool is_below(double value, const Threshold& threshold, bool active) {
  return value < (active ? threshold.end : threshold.begin);
}

constexpr int kStep_px = 8;  // of the sample
constexpr int kGrays = 256;

/// Calls use(row, col) for a sample of an image's pixels.
template <class Use>
void for_sample(const cv::Mat& image, const Use& use) {
  for (int row = kStep_px / 2; row < image.rows; row += kStep_px)
    for (int col = kStep_px / 2; col < image.cols; col += kStep_px) use(row, col);
}

void add_light(const cv::Mat& gray, RecordingSigns& signs) {
  if (gray.empty()) return;
  constexpr size_t kWhite = 250;
  constexpr double kBright = 0.95;
  std::array<int, kGrays> histogram{};
  int count = 0;
  for_sample(gray, [&](int row, int col) {
    ++histogram[gray.at<uint8_t>(row, col)];
    ++count;
  });
  if (count == 0) return;
  int white = 0, below = 0, level = 0;
  for (size_t value = kWhite; value < histogram.size(); ++value) white += histogram[value];
  while (level + 1 < kGrays && below + histogram[static_cast<size_t>(level)] < kBright * count)
    below += histogram[static_cast<size_t>(level++)];
  signs.saturated_share = static_cast<double>(white) / count;
  signs.bright_level = level;
}

void add_depth(const cv::Mat& depth_m, RecordingSigns& signs) {
  std::vector<float> depths_m;
  size_t count = 0;
  for_sample(depth_m, [&](int row, int col) {
    const float z_m = depth_m.at<float>(row, col);
    if (z_m > 0) depths_m.push_back(z_m);
    ++count;
  });
  if (count == 0) return;
  signs.depth_share = static_cast<double>(depths_m.size()) / static_cast<double>(count);
  if (depths_m.empty()) return;
  signs.depth_m = median(std::move(depths_m));
}

/// How long the signs of a hint must have lasted for it to begin, or been away for it to end.
int64_t wait_until_change_ns(RecordingHint hint, bool active) {
  constexpr int64_t kBegins_ns = kNsPerSecond / 2, kSwing_ns = kNsPerSecond / 5, kEnds_ns = 2 * kNsPerSecond;
  if (active) return kEnds_ns;
  if (hint == RecordingHint::kInDoubt) return 0;
  return hint == RecordingHint::kTooFast ? kSwing_ns : kBegins_ns;
}

}  // namespace

const char* name_of(RecordingHint hint) {
  switch (hint) {
    case RecordingHint::kInDoubt:
      return "in_doubt";
    case RecordingHint::kTooFast:
      return "too_fast";
    case RecordingHint::kNoDepth:
      return "no_depth";
    case RecordingHint::kTooNear:
      return "too_near";
    case RecordingHint::kTooDark:
      return "too_dark";
    case RecordingHint::kOverexposed:
      return "overexposed";
    case RecordingHint::kFewFeatures:
      return "few_features";
  }
  return "";
}

const char* text_of(RecordingHint hint) {
  switch (hint) {
    case RecordingHint::kInDoubt:
      return "Tracking is in doubt: go back slowly to what you have recorded";
    case RecordingHint::kTooFast:
      return "Too fast: move and turn more slowly";
    case RecordingHint::kNoDepth:
      return "Hardly any depth: too near, too far, sunlight or glass; look elsewhere";
    case RecordingHint::kTooNear:
      return "Too near: step back";
    case RecordingHint::kTooDark:
      return "Too dark: switch on a light";
    case RecordingHint::kOverexposed:
      return "Too bright: turn away from the window or lamp";
    case RecordingHint::kFewFeatures:
      return "Too plain: keep edges, pictures or furniture in view";
  }
  return "";
}

RecordingSigns signs_of(const TrackedFrame& tracked) {
  RecordingSigns signs;
  add_light(tracked.frame->gray, signs);
  add_depth(tracked.frame->depth_m, signs);
  signs.in_doubt = tracked.is_doubtful() || tracked.is_lost();
  if (tracked.is_lost()) return signs;  // what follows is of the pose
  const Velocity& velocity = tracked.velocity;
  signs.image_motion_rad_s = velocity.angular_rad_s.norm() + velocity.linear_m_s.norm() / signs.depth_m;
  signs.inliers = tracked.is_tracked_by_landmarks() ? tracked.evidence.inliers : 0;
  return signs;
}

RecordingHints advice(const RecordingSigns& signs, const RecordingHints& active) {
  RecordingHints hints;
  const auto give = [&](RecordingHint hint, bool holds) { hints.set(static_cast<size_t>(hint), holds); };
  const auto given = [&](RecordingHint hint) { return active.test(static_cast<size_t>(hint)); };
  using enum RecordingHint;
  const bool no_depth = is_below(signs.depth_share, kDepthShare, given(kNoDepth));
  give(kInDoubt, signs.in_doubt);
  give(kTooFast, is_above(signs.image_motion_rad_s, kFast_rad_s, given(kTooFast)));
  give(kNoDepth, no_depth);
  give(kTooNear, !no_depth && is_below(signs.depth_m, kNear_m, given(kTooNear)));
  give(kTooDark, is_below(signs.bright_level, kDark, given(kTooDark)));
  give(kOverexposed, is_above(signs.saturated_share, kSaturated, given(kOverexposed)));
  give(kFewFeatures, is_below(signs.inliers, kFewInliers, given(kFewFeatures)));
  return hints;
}

void RecordingAdvisor::observe(int64_t stamp_ns, const RecordingSigns& signs) {
  if (begun_) {
    const double passed_s = std::clamp(to_seconds(stamp_ns - stamp_ns_), 0.0, 1.0);
    for (size_t i = 0; i < kRecordingHints; ++i) seconds_[i] += active_.test(i) ? passed_s : 0;
  }
  const RecordingHints wanted = advice(signs, active_);
  for (size_t i = 0; i < kRecordingHints; ++i) {
    const bool changes = wanted.test(i) != active_.test(i);
    if (changes && !changing_.test(i)) changing_ns_[i] = stamp_ns;
    changing_.set(i, changes);
    const int64_t wait_ns = wait_until_change_ns(static_cast<RecordingHint>(i), active_.test(i));
    if (!changes || stamp_ns - changing_ns_[i] < wait_ns) continue;
    active_.flip(i);
    changing_.reset(i);
  }
  stamp_ns_ = stamp_ns;
  begun_ = true;
}

std::vector<RecordingHint> RecordingAdvisor::hints() const {
  constexpr size_t kMost = 3;
  std::vector<RecordingHint> hints;
  for (size_t i = 0; i < kRecordingHints && hints.size() < kMost; ++i)
    if (active_.test(i)) hints.push_back(static_cast<RecordingHint>(i));
  return hints;
}

}  // namespace kinloop
