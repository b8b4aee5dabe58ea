#pragma once
// What the result of a run should make its user look at.

#include <string>

#include "apps/depth_watch.hpp"
#include "apps/run_summary.hpp"

namespace kinloop {

/// Warns of a map without points, of depth that cannot be right and of ground truth that does not belong to
/// the frames. False where the depth is of no use: the map is not worth having.
bool judge_result(const RunOutcome& outcome, const Trajectory& trajectory, const DepthWatch& depth);

/// Why the run ended without knowing where the camera is.
std::string loss_text(const Map& map);

}  // namespace kinloop
