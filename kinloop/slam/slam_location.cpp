// A camera that was located by the look of an image, or after a gap, may be in another place that looks
// alike. The next frames confirm where it is; until then its poses are in doubt and no keyframe is made. They
// go on to check it, and what was made of a place that they contradict is taken back.

#include <algorithm>
#include <utility>

#include "kinloop/back_end/withdraw_keyframes.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/slam/slam.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"

namespace kinloop {
namespace {

constexpr int64_t kChecked_ns = 20 * kNsPerSecond;  // how long a place is checked after it was recognized
constexpr int64_t kSettled_ns = 5 * kNsPerSecond;   // when it is not taken back any more because of the next
constexpr int64_t kRefused_ns = 2 * kNsPerSecond,
                  kSuspected_ns = 60 * kNsPerSecond;  // after it was contradicted

/// Whether a part of the map was contradicted no longer ago than this.
bool is_cooling_down(const std::optional<RelocalizationCooldown>& cooldown, uint32_t component,
                     int64_t now_ns, int64_t duration_ns) {
  return cooldown && cooldown->component == component && now_ns >= cooldown->contradicted_ns &&
         now_ns - cooldown->contradicted_ns < duration_ns;
}

/// Whether the keypoints of a frame say what its place looks like.
bool shows_place(const TrackedFrame& tracked) {
  const Features* features = tracked.frame->features.get();
  return features != nullptr && features->has_descriptors() && !tracked.is_repeat();
}

/// Whether nothing seems to have moved: behind what has, a place looks different.
bool is_at_rest(const TrackedFrame& tracked) {
  constexpr double kMaxContradicted = 0.02;
  return tracked.evidence.moved_share == 0 &&
         tracked.evidence.surfaces.contradicted_share() < kMaxContradicted;
}

/// Whether a place has been checked for long enough; never before it is confirmed.
bool is_done(const RelocalizationTrial& place, int64_t now_ns) {
  return place.check.is_confirmed() && now_ns - place.begin_ns > kChecked_ns;
}

/// Remembers when the camera was located anew. What it is compared with is the map from before it was lost
/// for the first time: later keyframes may be of another place.
void restart_trial(std::optional<RelocalizationTrial>& place, const RelocalizationTrial& now) {
  if (!place) {
    place = now;
  } else if (place->check.is_confirmed() && now.begin_ns - place->begin_ns > kSettled_ns) {
    place = RelocalizationTrial{now.begin, now.begin_ns, place->end, now.component};
  } else {
    place->check = {};
    place->begin_ns = now.begin_ns;
  }
}

}  // namespace

/// Recognizes a place, but not at once in the part of the map that has just been contradicted: the frames
/// would have to contradict it again. Later, one frame is not enough there.
std::optional<TrackedFrame> Slam::relocalize(const Frame& frame) const {
  auto found = places_.relocalize(frame, map_);
  if (!found) return std::nullopt;
  const uint32_t component = map_.keyframe(found->reference).component;
  if (is_cooling_down(place_.cooldown, component, frame.stamp_ns, kRefused_ns)) return std::nullopt;
  if (is_cooling_down(place_.cooldown, component, frame.stamp_ns, kSuspected_ns))
    doubt(*found, DoubtCause::kPlace);
  return found;
}

/// Whether the camera may have been carried to another place since the last frame with a pose, or has been
/// recognized long after the last pose beyond doubt.
bool Slam::is_located_anew(const TrackedFrame& tracked) const {
  constexpr int64_t kCarried_ns = 2 * kNsPerSecond;
  const bool recognized = tracked.outcome == TrackingOutcome::kRelocalized;
  const auto frames = session_log();
  const auto last = std::find_if(frames.rbegin(), frames.rend(), [&](const LoggedFrame& frame) {
    return !frame.is_lost() && !(recognized && frame.is_doubtful());
  });
  return last == frames.rend() || tracked.stamp_ns - last->stamp_ns > kCarried_ns;
}

/// Adds what a frame says of its place. Once that is confirmed, surfaces in front of it have probably moved
/// there, unless few landmarks agree.
void Slam::examine(const TrackedFrame& tracked, RelocalizationTrial& place) const {
  constexpr int64_t kBetweenLooks_ns = 3 * kNsPerSecond / 10;
  if (!shows_place(tracked)) return;
  const bool confirmed = place.check.is_confirmed();
  const bool confident = is_confident(tracked, tracked.features());
  const bool as_before = !confirmed || (!confident && tracked.evidence.moved_share == 0);
  const bool look =
      confirmed && is_at_rest(tracked) && tracked.stamp_ns - place.looked_ns >= kBetweenLooks_ns;
  if (!as_before && !look) return;
  const LocationEvidence evidence = places_.examine(tracked, map_, place.end);
  if (as_before) place.check.add(evidence, confident);
  if (!look) return;
  place.check.add_appearance(evidence.appearance_p_value);
  place.looked_ns = tracked.stamp_ns;
}

/// Checks the place of a frame in the map. The frame becomes provisional if it is not confirmed yet, and lost
/// if it is contradicted.
void Slam::check_location(TrackedFrame& tracked) {
  if (!tracked.is_located()) return;
  const uint32_t component = map_.keyframe(tracked.reference).component;
  if (place_.trial && (place_.trial->component != component || is_done(*place_.trial, tracked.stamp_ns)))
    place_.trial.reset();
  const KeyframeId end{static_cast<uint32_t>(map_.keyframes().size())};
  if (is_located_anew(tracked)) restart_trial(place_.trial, {log_.size(), tracked.stamp_ns, end, component});
  if (!place_.trial) return;
  const bool was_confirmed = place_.trial->check.is_confirmed();
  examine(tracked, *place_.trial);
  const LocationCheck& check = place_.trial->check;
  if (check.is_contradicted()) return take_back_location(tracked);
  // Where the camera was said to be before, and was not, it has to be seen for longer.
  const bool too_early = is_cooling_down(place_.cooldown, component, tracked.stamp_ns, kSuspected_ns) &&
                         tracked.stamp_ns - place_.trial->begin_ns < kRefused_ns;
  if (!check.is_confirmed() || too_early) {
    tracked.provisional = true;
    doubt(tracked, DoubtCause::kPlace);
  } else if (!was_confirmed) {
    trust_place_since(place_.trial->begin_ns, component);
  }
}

/// The frame that confirms the place also confirms those since the camera was located there.
void Slam::trust_place_since(int64_t since_ns, uint32_t component) {
  for (size_t i = log_.size(); i-- > earlier_.frame_count && log_[i].stamp_ns >= since_ns;) {
    if (log_[i].trust.cause == DoubtCause::kPlace && is_tracked_in(component, log_[i], map_))
      log_[i].trust = {};
  }
}

/// Makes the frames since the camera was located lost and withdraws their keyframes. The camera has to be
/// found anew, or is in a part of the world that is not mapped.
void Slam::take_back_location(TrackedFrame& tracked) {
  const RelocalizationTrial place = *std::exchange(place_.trial, std::nullopt);
  place_.cooldown = RelocalizationCooldown{place.component, tracked.stamp_ns};
  back_end_.require_more_evidence(tracked.reference);
  if (place.begin < log_.size() && withdraw_keyframes(place.begin, place.component, map_, log_))
    map_changed_ = true;
  for (size_t i = place.begin; i < log_.size(); ++i)
    if (is_tracked_in(place.component, log_[i], map_)) lose(log_[i]);
  lose(tracked);  // also if its reference has been withdrawn
  tracked.provisional = false;
  tracker_.reset();
}

}  // namespace kinloop
