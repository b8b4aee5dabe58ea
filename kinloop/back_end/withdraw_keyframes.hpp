#pragma once
// Takes back the part of a map that turned out to be made from wrong poses.

#include <optional>

#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

/// Withdraws the keyframes that the frames from `begin` on became in a component of the map. The poses of
/// those frames stay where they are in the world, in doubt, relative to the newest keyframe before. Returns
/// that keyframe; nullopt if nothing was withdrawn, because there are no such keyframes or none before.
std::optional<KeyframeId> withdraw_keyframes(size_t begin, uint32_t component, Map& map, FrameLog& log);

}  // namespace kinloop
