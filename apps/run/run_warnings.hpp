#pragma once
// What the result of a run should make its user look at.

#include <string>

#include "apps/run/depth_monitor.hpp"
#include "apps/run/run_summary.hpp"

namespace kinloop {

/// Warns of a map without points, of depth that cannot be right and of ground truth that does not belong to
/// the frames. False where the depth is of no use: the map is not worth having.
bool check_result(const RunOutcome& outcome, const Trajectory& trajectory, const DepthMonitor& depth);

/// Why the run ended without knowing where the camera is.
std::string describe_tracking_loss(const Map& map);

}  // namespace kinloop
