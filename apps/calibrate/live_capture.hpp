#pragma once
// kinloop calibrate --live: stills from a live camera, with hints on the terminal and in the browser.

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/calibration/capture.hpp"

namespace kinloop {

/// What the user asked for; without a source, nothing.
struct LiveCaptureOptions {
  std::string source;  ///< as for kinloop run
  size_t wanted = 20;
  std::string viewer;  ///< where to listen; empty: no browser
};

/// --live, --stills and --viewer.
void add_live_options(CLI::App& command, LiveCaptureOptions& live);

/// Takes stills into `folder` until there are enough, the source ends or Ctrl-C is pressed. Throws InputError
/// where the folder is not empty or the source cannot give what `kind` needs.
void capture_live_stills(const LiveCaptureOptions& live, const std::filesystem::path& folder,
                         const Board& board, StillKind kind);

}  // namespace kinloop
