#pragma once
// Checks the result of a run for problems.

#include <filesystem>

#include "apps/run/depth_monitor.hpp"
#include "apps/run/run_summary.hpp"
#include "apps/shared/commands.hpp"

namespace kinloop {

/// Warns of skipped frames, a map without points, implausible depth and ground truth that does not match the
/// frames. Returns false if over half of the frames were skipped, or if the depth is unusable, and so is the
/// map.
bool check_result(const RunOutcome& outcome, const Trajectory& trajectory, const DepthMonitor& depth);

/// Returns the exit code of a run for scripts: the signal that ended it (0: none), or whether tracking was
/// lost at the end or never started; then it says why and names `details`, a file.
ExitCode exit_code(const Slam& slam, int signal, const std::filesystem::path& details);

}  // namespace kinloop
