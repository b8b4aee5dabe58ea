#pragma once
// Writes report.html from the other files in the folders of runs.

#include <filesystem>
#include <vector>

#include "kinloop/io/run_folder.hpp"

namespace kinloop {

/// Writes the report of one run into its folder. Throws InputError if a required file is missing or damaged;
/// all but trajectory.txt and run.json are optional.
void write_report(const RunFolder& folder);

/// Writes a page that compares several runs: run folders, and trajectories in TUM format from any other
/// system, which are evaluated with the ground truth of the first run that has one.
void write_comparison(const std::vector<std::filesystem::path>& runs, const std::filesystem::path& page);

}  // namespace kinloop
