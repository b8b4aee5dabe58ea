#pragma once
// In: a path, or a map. Out: what the page shows of it.

#include <filesystem>
#include <span>

#include "kinloop/core/progress.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/map.hpp"
#include "session/store/map_store.hpp"
#include "viewer/saved/saved_run.hpp"

namespace kinloop {

/// Whether the name of the file is that of a map.
bool is_map_file(const std::filesystem::path& path);

/// Adds the keyframes and loops of a map, and the doubtful frames of one of its sessions.
void add_map(SavedRun& run, std::span<const LoggedFrame> session, const Map& map);

/// Returns all but the name and the cloud: the last run's path, and the keyframes of all runs.
SavedRun saved_run_of(OpenMap& open);

/// Reads what can be shown: the folder of a run, a cloud, a mesh, or a map file. Of a map file: the last
/// run's path, the keyframes of all runs, and a newly fused cloud, whose progress is reported. Throws
/// InputError naming what is missing or damaged.
SavedRun read_shown(const std::filesystem::path& path, const Progress& progress);

}  // namespace kinloop
