#pragma once
// In: a map file. Out: what the page shows of it.

#include <filesystem>

#include "kinloop/core/progress.hpp"
#include "session/map_store.hpp"
#include "viewer/saved_run.hpp"

namespace kinloop {

/// Whether the name of the file is that of a map.
bool is_map_file(const std::filesystem::path& path);

/// Returns all but the name and the cloud: the last run's path, and the keyframes of all runs.
SavedRun saved_run_of(OpenMap& open);

/// Reads a map file: the last run's path, the keyframes of all runs, and a newly fused cloud. Throws
/// InputError naming what is damaged.
SavedRun read_saved_map(const std::filesystem::path& file, const Progress& progress);

}  // namespace kinloop
