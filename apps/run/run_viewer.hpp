#pragma once
// What `kinloop run --viewer` adds to a run.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "kinloop/io/run_folder.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/dense_recorder.hpp"
#include "kinloop/slam/slam.hpp"
#include "viewer/live_viewer.hpp"

namespace kinloop {

/// A run that is shown.
struct RunViewer {
  RunViewer(const ListenAddress& listen, RunInfo basics) : viewer(listen, std::move(basics)) {}

  LiveViewer viewer;
  std::function<void()>
      wait_until_resumed;  ///< to be called before every frame: waits while paused, saves when asked to
};

/// --viewer[=[ADDRESS:]PORT]; `listen` stays empty without.
CLI::Option* add_viewer_option(CLI::App& command, std::string& listen);

/// The words of a command line with "--viewer" "9000" joined to "--viewer=9000", where the second word is a
/// port or an address: CLI11 would take any word after an option whose value may be left out.
std::vector<std::string> join_viewer_address(std::vector<std::string> words);

/// Begins to show the run, if `listen` asks for it, and says where. Slam must not outlive the result.
std::unique_ptr<RunViewer> start_run_viewer(const std::string& listen, const FrameSource& source,
                                            const ViewerOptions& options, Slam& slam,
                                            const std::function<void()>& save_now);

/// Writes trajectory and map as they are now, the map in the frame that `--frame` names.
void save_map(const RunFolder& folder, const Slam& slam, DenseRecorder& recorder, const std::string& frame,
              int threads);

/// After the run: where somebody sits at the terminal, goes on serving until Ctrl-C; otherwise only until
/// those who watch have the last state.
void serve_until_interrupted(LiveViewer& viewer);

}  // namespace kinloop
