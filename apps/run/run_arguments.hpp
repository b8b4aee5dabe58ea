#pragma once
// The command line arguments of `kinloop run`.

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "session/plan/run_plan.hpp"

namespace kinloop {

struct RunArguments {
  RunRequest request;
  std::filesystem::path output = "out";
  std::string frame = "z-up";
  std::string list_options;  ///< "true": the documented ones; "all"; empty: none
  bool quiet = false;
  bool profile = false;
  bool verbose = false;
  std::string viewer;    ///< [ADDRESS:]PORT; empty: none
  std::string poses_to;  ///< where the pose of each frame goes, see open_line_output; empty: nowhere
  std::filesystem::path save_map;
  std::filesystem::path trajectory;  ///< a second copy, in the format of its name; empty: none
  bool report = false;
  bool keep_doubtful = false;  ///< in trajectory.txt
  double autosave_s = 30;

  /// Returns whether no cloud and no report are written.
  [[nodiscard]] bool poses_only() const { return request.settings.localize && !report; }
};

/// Adds the options of `kinloop run`, with examples for --help.
void add_run_arguments(CLI::App& command, RunArguments& arguments);

}  // namespace kinloop
