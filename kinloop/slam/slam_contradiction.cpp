// A camera that begins to follow something that moves makes it a part of the map, which then confirms its
// pose. What it made of the view while that contradicted the map is taken back when the poses have been in
// doubt for long.

#include "kinloop/back_end/final/revise_doubt.hpp"
#include "kinloop/back_end/withdraw_keyframes.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {

/// Returns the first frame of those that contradict the map if their poses have been in doubt for long.
std::optional<size_t> Slam::contradicted_since() const {
  constexpr int64_t kMinDoubt_ns = kNsPerSecond / 2;
  const auto since_ns = tracker_.doubtful_since_ns();
  if (options_.localize_only || !since_ns || log_.back().is_lost()) return std::nullopt;
  if (log_.back().stamp_ns - *since_ns < kMinDoubt_ns) return std::nullopt;
  size_t first_in_doubt = log_.size() - 1;
  while (first_in_doubt > earlier_.frame_count && log_[first_in_doubt].stamp_ns > *since_ns) --first_in_doubt;
  return contradiction_start(log_, earlier_.frame_count, first_in_doubt);
}

/// Withdraws the keyframes made since then. Tracking goes on with the map as it was.
void Slam::withdraw_contradicted() {
  const auto begin = contradicted_since();
  if (!begin) return;
  const uint32_t component = map_.keyframe(log_.back().reference).component;
  const auto last = withdraw_keyframes(*begin, component, map_, log_);
  if (!last) return;
  const KeyframeId reference = tracker_.reference();
  tracker_.update(map_, map_.keyframe(reference).withdrawn ? *last : reference);
  map_changed_ = true;
}

}  // namespace kinloop
