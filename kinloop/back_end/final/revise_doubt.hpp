#pragma once
// Decides at the end which poses are doubtful: more is known then than when they were tracked.

#include <optional>

#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

/// Returns the log with more doubtful frames; those before `first` are left as they are.
///
/// - A pose is doubtful if it jumps: the motion of a hand does not explain it.
/// - Doubt extends from doubtful and lost frames to their neighbours, up to 2 s away, for as long as much of
///   the view moves or contradicts the pose. A camera that begins to follow something that moves finds enough
///   that agrees; that it was not the room becomes clear later.
FrameLog revise_doubt(FrameLog log, size_t first, const Map& map);

/// Returns since which frame, at most 2 s before frame `last`, much of what has not moved has contradicted
/// the pose up to `last`; nullopt if it does not there. Frames before `first` are not looked at.
std::optional<size_t> contradiction_start(const FrameLog& log, size_t first, size_t last);

}  // namespace kinloop
