// A camera that was located by the look of an image, or after a gap, may be in another place that looks
// alike. The next frames confirm where it is; until then its poses are in doubt and no keyframe is made. They
// go on to check it, and what was made of a place that they refute is taken back.

#include <utility>

#include "kinloop/back_end/withdraw_keyframes.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/slam/slam.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"

namespace kinloop {
namespace {

constexpr int64_t kChecked_ns = 20 * kNsPerSecond;  // how long a place is checked after it was recognized

}  // namespace

/// Recognizes a place, but not at once in the part of the map that has just been refuted: the frames would
/// have to refute it again.
std::optional<TrackedFrame> Slam::relocalize(const Frame& frame) const {
  constexpr int64_t kRefused_ns = 2 * kNsPerSecond;
  auto found = places_.relocalize(frame, map_);
  const bool refused = found && refuted_ &&
                       map_.keyframe(found->reference).component == refuted_->component &&
                       frame.stamp_ns - refuted_->refuted_ns < kRefused_ns;
  if (refused) return std::nullopt;
  return found;
}

/// Whether a pose does not continue the motion before: after recognition, a loss or a gap.
bool Slam::is_located_anew(const TrackedFrame& tracked) const {
  constexpr int64_t kMinGap_ns = kNsPerSecond / 4;
  constexpr int64_t kMinIntervals = 3;
  if (tracked.outcome == TrackingOutcome::kRelocalized) return true;
  const auto frames = session_log();
  if (frames.empty() || frames.back().is_lost()) return true;
  const int64_t gap_ns = tracked.stamp_ns - frames.back().stamp_ns;
  if (frames.size() < 2 || gap_ns < kMinGap_ns) return false;
  return gap_ns > kMinIntervals * (frames.back().stamp_ns - frames[frames.size() - 2].stamp_ns);
}

/// Checks the place of a frame in the map. The frame becomes provisional if it is not confirmed yet, and lost
/// if it is refuted.
void Slam::check_location(TrackedFrame& tracked) {
  if (!tracked.is_located()) return;
  const uint32_t component = map_.keyframe(tracked.reference).component;
  if (located_ && (located_->component != component || tracked.stamp_ns - located_->begin_ns > kChecked_ns))
    located_.reset();
  if (is_located_anew(tracked)) {
    if (!located_) {
      const KeyframeId end{static_cast<uint32_t>(map_.keyframes().size())};
      located_ = LocatedPlace{log_.size(), tracked.stamp_ns, end, component};
    }
    located_->check = {};
  }
  if (!located_) return;
  const Features* features = tracked.frame->features.get();
  if (features != nullptr && features->has_descriptors() && !tracked.is_repeat())
    located_->check.add(places_.examine(tracked, map_, located_->end), is_confident(tracked, *features));
  if (located_->check.is_refuted()) return take_back_location(tracked);
  if (located_->check.is_confirmed()) return confirm_location();
  if (!tracked.doubtful) located_->doubted.push_back(log_.size());
  tracked.provisional = tracked.doubtful = true;
}

/// Ends the doubt of the provisional frames before.
void Slam::confirm_location() {
  for (const size_t i : std::exchange(located_->doubted, {})) log_[i].doubtful = false;
}

/// Makes the frames since the camera was located lost and withdraws their keyframes. The camera has to be
/// found anew, or is in a part of the world that is not mapped.
void Slam::take_back_location(TrackedFrame& tracked) {
  const LocatedPlace place = *std::exchange(located_, std::nullopt);
  refuted_ = RefutedPlace{place.component, tracked.stamp_ns};
  if (place.begin < log_.size() && withdraw_keyframes(place.begin, place.component, map_, log_))
    map_changed_ = true;
  const auto lose = [&](TrackedFrame& frame) {
    if (!is_tracked_in(place.component, frame, map_)) return;
    frame.outcome = TrackingOutcome::kLost;
    frame.provisional = false;
    frame.matches.clear();
    frame.measurements.clear();
  };
  for (size_t i = place.begin; i < log_.size(); ++i) lose(log_[i]);
  lose(tracked);
  tracker_.reset();
}

}  // namespace kinloop
