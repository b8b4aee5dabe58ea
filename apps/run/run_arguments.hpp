#pragma once
// The command line arguments of `kinloop run`.

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kinloop {

struct RunArguments {
  std::string sequence;
  std::filesystem::path output = "out";
  std::string camera;
  std::string topics;
  std::string solver;  ///< empty: that of the options
  std::string vocabulary;
  std::string frame = "z-up";
  bool no_loop = false;
  std::string list_options;  ///< "true": the documented ones; "all"; empty: none
  bool quiet = false;
  bool profile = false;
  bool verbose = false;
  int threads = 0;
  std::string viewer;  // [ADDRESS:]PORT; empty: none
  double pace_hz = 0;
  std::filesystem::path save_map;
  std::filesystem::path load_map;
  bool localize = false;
  bool report = false;
  double autosave_s = 30;
  int memory_mib = 0;  ///< 0: that of the options
  std::vector<std::string> assignments;
};

/// Adds the options of `kinloop run`, with examples for --help.
void add_run_arguments(CLI::App& command, RunArguments& arguments);

}  // namespace kinloop
