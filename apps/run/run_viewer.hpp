#pragma once
// The `--viewer` option of `kinloop run`.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "session/session.hpp"
#include "viewer/live/live_viewer.hpp"

namespace kinloop {

/// A run with a live viewer.
struct RunViewer {
  RunViewer(const ListenAddress& listen, RunInfo basics) : viewer(listen, std::move(basics)) {}

  LiveViewer viewer;
  std::function<void()>
      wait_until_resumed;  ///< to be called before every frame: blocks while paused, saves on request
};

/// Adds --viewer[=[ADDRESS:]PORT]; `listen` stays empty without it.
CLI::Option* add_viewer_option(CLI::App& command, std::string& listen);

/// Joins the words "--viewer" "9000" of a command line to "--viewer=9000" if the second is a port or an
/// address: CLI11 would take any word after an option with an optional value.
std::vector<std::string> join_viewer_address(std::vector<std::string> words);

/// Begins to show the run, if `listen` asks for it, and says where. The session must not outlive the result.
std::unique_ptr<RunViewer> start_run_viewer(const std::string& listen, const ViewerOptions& options,
                                            Session& session, const std::function<void()>& save_now);

/// Shows where the input contradicts itself, as far as that is known.
void show_warnings(LiveViewer& viewer, const InputMonitor& input);

/// After the run: on a terminal, serves until Ctrl-C; otherwise only until connected browsers have the final
/// state.
void serve_until_interrupted(LiveViewer& viewer);

}  // namespace kinloop
