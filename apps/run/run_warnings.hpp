#pragma once
// Checks the result of a run for problems.

#include <string>

#include "apps/run/depth_monitor.hpp"
#include "apps/run/run_summary.hpp"

namespace kinloop {

/// Warns of a map without points, implausible depth and ground truth that does not match the frames. Returns
/// false if the depth is unusable, and so is the map.
bool check_result(const RunOutcome& outcome, const Trajectory& trajectory, const DepthMonitor& depth);

/// Explains why the run ended without a current pose.
std::string describe_tracking_loss(const Map& map);

}  // namespace kinloop
