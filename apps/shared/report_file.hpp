#pragma once
// report.html, from the other files in the folders of runs.

#include <filesystem>
#include <vector>

#include "kinloop/io/run_folder.hpp"

namespace kinloop {

/// Writes the report of one run into its folder. Throws InputError when a file that it needs is missing or
/// damaged; all but trajectory.txt and run.json may be missing.
void write_report(const RunFolder& folder);

/// Writes a page that puts several runs side by side: folders of runs, and trajectories in the TUM format
/// that any other system has left, which are compared with the ground truth of the first run that has one.
void write_comparison(const std::vector<std::filesystem::path>& runs, const std::filesystem::path& page);

}  // namespace kinloop
