#pragma once
// In: an opened map. Out: the parts of a recording for Rerun as files, which python/kinloop/_rerun.py puts
// into one .rrd file, since that format is written by Rerun's own library alone.

#include <filesystem>
#include <string>

#include "session/store/map_store.hpp"

namespace kinloop {

struct RerunRequest {
  std::filesystem::path map;  ///< named in errors
  size_t session = 0;
  int threads = 1;
  size_t images = 0;      ///< as of SparseModelRequest
  std::string recording;  ///< empty: as the map names it
};

/// Writes `cloud.ply`, images with their poses (`transforms.json`), and `run.json`: poses and status of the
/// frames of the session, keyframes and loop closures; `file` has the cloud and its frame. Throws InputError
/// as `export_sparse_model` does.
void write_rerun_parts(const std::filesystem::path& folder, const RerunRequest& request,
                       const FileCloud& file, OpenMap& open, const Progress& progress);

}  // namespace kinloop
