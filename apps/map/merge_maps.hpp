#pragma once
// In: two map files of one camera. Out: one map that holds both, joined where a place of one is recognised in
// the other, and optimised.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "kinloop/core/progress.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {

struct MergeRequest {
  std::filesystem::path a, b;   ///< map files, or folders of runs
  std::string vocabulary = {};  ///< file; empty: built-in
  std::vector<std::string> assignments = {};
};

struct MergedMaps {
  RgbdCamera camera;
  RunOptions options;
  std::unique_ptr<Slam> slam;
  std::unique_ptr<DenseRecorder> recorder;
  FrameId first_of_b;        ///< frames of `a` come before it
  size_t loops_between = 0;  ///< 0: nothing of one map was recognised in the other
};

/// Merges the maps; the world frame is that of `a`. Throws InputError if a file cannot be read or the maps
/// are of different cameras.
MergedMaps merge_maps(const MergeRequest& request, const Progress& progress);

/// Returns the files that a merge reads. Throws InputError for a folder without a map.
std::vector<std::filesystem::path> inputs_of(const MergeRequest& request);

/// Adds A, B, --vocabulary and --set to a command.
void add_map_arguments(CLI::App& command, MergeRequest& maps);

}  // namespace kinloop
