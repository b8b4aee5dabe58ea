#include "session/run_quality.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "kinloop/core/time.hpp"
#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {
namespace {

// A longer interval is a pause of the camera, for which the frame before it is not to blame.
constexpr double kMaxInterval_s = 1;
constexpr double kOnlyFrame_s = 1.0 / 30;

FrameTrust trust_of(const LoggedFrame& entry, uint32_t component, const Map& map) {
  if (entry.is_lost()) return FrameTrust::kLost;
  if (!is_tracked_in(component, entry, map)) return FrameTrust::kElsewhere;
  return entry.is_doubtful() ? FrameTrust::kDoubtful : FrameTrust::kTrusted;
}

/// The time that each frame counts for, s.
std::vector<double> durations_s(std::span<const JudgedFrame> frames) {
  std::vector<double> durations;
  for (size_t i = 1; i < frames.size(); ++i) {
    const double interval_s = to_seconds(frames[i].stamp_ns - frames[i - 1].stamp_ns);
    durations.push_back(std::clamp(interval_s, 0.0, kMaxInterval_s));
  }
  if (!frames.empty()) durations.push_back(durations.empty() ? kOnlyFrame_s : durations.back());
  return durations;
}

/// Successive frames of the same trust, in seconds since the first frame of the run.
struct Interval {
  double from_s = 0, to_s = 0;
};

/// The time in which the frames have this trust.
struct Share {
  double total_s = 0;
  Interval longest;
};

Share share_of(FrameTrust trust, std::span<const JudgedFrame> frames, std::span<const double> durations) {
  Share share;
  Interval current;
  bool inside = false;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].trust != trust) {
      inside = false;
      continue;
    }
    const double at_s = to_seconds(frames[i].stamp_ns - frames.front().stamp_ns);
    if (!inside) current.from_s = at_s;
    inside = true;
    current.to_s = at_s + durations[i];
    share.total_s += durations[i];
    if (current.to_s - current.from_s > share.longest.to_s - share.longest.from_s) share.longest = current;
  }
  return share;
}

void add_reason(RunQuality& quality, const Share& share, const char* what) {
  if (share.total_s <= 0) return;
  quality.reasons.push_back(fmt::format("{:.1f} s of {:.1f} s are {} (longest: {:.1f} s to {:.1f} s)",
                                        share.total_s, quality.seconds, what, share.longest.from_s,
                                        share.longest.to_s));
}

/// Adds that a part of the image was left out, unless that took less than a second.
void add_left_out(RunQuality& quality, std::span<const JudgedFrame> frames, std::span<const double> durations,
                  double JudgedFrame::*share, const char* what) {
  constexpr double kMinSeconds = 1;
  double seconds = 0, most = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].*share <= 0) continue;
    seconds += durations[i];
    most = std::max(most, frames[i].*share);
  }
  if (seconds < kMinSeconds) return;
  quality.reasons.push_back(
      fmt::format("{} for {:.1f} s, up to {:.0f} % of the image; it is left out", what, seconds, 100 * most));
}

/// Adds when the scale of depth changed, and for how long there was none, unless that took less than a
/// second.
void add_depth(RunQuality& quality, std::span<const JudgedFrame> frames, std::span<const double> durations) {
  constexpr double kMinSeconds = 1;
  double without_s = 0, factor = 1;
  for (size_t i = 0; i < frames.size(); ++i) {
    const double now = frames[i].depth_factor;
    if (now == 0) {
      without_s += durations[i];
    } else if (std::exchange(factor, now) != now) {
      quality.reasons.push_back(fmt::format(
          "from {1:.1f} s on all depths are {0:.3f} of what they were at first; they are scaled back",
          1 / now, to_seconds(frames[i].stamp_ns - frames.front().stamp_ns)));
    }
  }
  if (without_s >= kMinSeconds)
    quality.reasons.push_back(fmt::format("depth is frozen or missing for {:.1f} s", without_s));
}

Verdict verdict_on(double share_of_time) {
  constexpr double kGoodBelow = 0.005, kBadAbove = 0.2;
  if (share_of_time < kGoodBelow) return Verdict::kGood;
  return share_of_time > kBadAbove ? Verdict::kBad : Verdict::kDoubtful;
}

}  // namespace

std::vector<JudgedFrame> judged_frames(std::span<const LoggedFrame> log, const Map& map) {
  const uint32_t component = main_component(log, map);
  std::vector<JudgedFrame> frames;
  for (const LoggedFrame& entry : log) {
    frames.push_back({entry.stamp_ns, trust_of(entry, component, map), entry.evidence.input.fixed_share,
                      entry.evidence.moved_share, entry.evidence.input.depth_factor});
  }
  return frames;
}

RunQuality judge(std::span<const JudgedFrame> frames) {
  RunQuality quality;
  const auto durations = durations_s(frames);
  for (const double duration : durations) quality.seconds += duration;
  if (quality.seconds <= 0) {
    quality.reasons.emplace_back("there are no frames");
    return quality;
  }
  const Share doubtful = share_of(FrameTrust::kDoubtful, frames, durations);
  const Share lost = share_of(FrameTrust::kLost, frames, durations);
  const Share elsewhere = share_of(FrameTrust::kElsewhere, frames, durations);
  quality.seconds_doubtful = doubtful.total_s;
  quality.seconds_lost = lost.total_s + elsewhere.total_s;
  quality.verdict = verdict_on((quality.seconds_doubtful + quality.seconds_lost) / quality.seconds);
  add_reason(quality, doubtful, "in doubt");
  add_reason(quality, lost, "lost");
  add_reason(quality, elsewhere, "in other components of the map");
  add_left_out(quality, frames, durations, &JudgedFrame::fixed_share, "something moves with the camera");
  add_left_out(quality, frames, durations, &JudgedFrame::moved_share, "something else moves");
  add_depth(quality, frames, durations);
  return quality;
}

RunQuality with_guessed_unit(RunQuality quality, const std::string& guess) {
  if (guess.empty()) return quality;
  if (quality.verdict == Verdict::kGood) quality.verdict = Verdict::kDoubtful;
  quality.reasons.push_back(guess);
  return quality;
}

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kBad:
      break;
  }
  return "bad";
}

}  // namespace kinloop
