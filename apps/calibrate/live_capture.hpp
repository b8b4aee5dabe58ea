#pragma once
// kinloop calibrate --live: captures images from a live camera, with hints on the terminal and in the
// browser.

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/calibration/capture.hpp"

namespace kinloop {

/// The options; inactive if `source` is empty.
struct LiveCaptureOptions {
  std::string source;  ///< as for kinloop run
  size_t wanted = 20;
  std::string viewer;  ///< [ADDRESS:]PORT to listen on; empty: no browser
};

/// Adds --live, --stills and --viewer.
void add_live_options(CLI::App& command, LiveCaptureOptions& live);

/// Captures images into `folder` until there are enough, the source ends or Ctrl-C is pressed. Throws
/// InputError if the folder is not empty or the source lacks the images that `kind` needs.
void capture_live_stills(const LiveCaptureOptions& live, const std::filesystem::path& folder,
                         const Board& board, StillKind kind);

}  // namespace kinloop
