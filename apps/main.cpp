// The kinloop program: parses the command line, runs one command, and turns exceptions into one line and an
// exit code.

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "apps/run/run_viewer.hpp"
#include "apps/shared/command_line.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/memory.hpp"
#include "apps/shared/version.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/input_error_with_hint.hpp"
#include "kinloop/base/log.hpp"

namespace {

using kinloop::ExitCode;

void set_up_log() {
  // Results go to standard output, messages to standard error.
  auto logger = spdlog::stderr_color_st("kinloop");
  logger->set_pattern("%^%l:%$ %v");
  spdlog::set_default_logger(logger);
}

ExitCode run(int argc, char** argv) {
  if (argc <= 1) {
    kinloop::print_quick_start();
    return ExitCode::kDone;
  }
  CLI::App app(
      "kinloop: RGB-D SLAM on a CPU: camera trajectory and coloured 3D map from a Kinect-class camera.\n"
      "Start with: kinloop run sim:room -o out    (then open out/report.html)",
      "kinloop");
  app.set_version_flag("--version", kinloop::version_text());
  app.require_subcommand(1);
  ExitCode exit_code = ExitCode::kDone;
  kinloop::add_run_command(app, exit_code);
  kinloop::add_probe_command(app);
  kinloop::add_eval_command(app);
  kinloop::add_view_command(app);
  kinloop::add_report_command(app);
  kinloop::add_vocab_command(app);
  kinloop::add_optimize_command(app);
  kinloop::add_simulate_command(app);
  kinloop::add_bench_command(app);
  kinloop::add_features_command(app);
  kinloop::add_calibrate_command(app);
  kinloop::add_record_command(app);
  kinloop::add_fetch_command(app);
  kinloop::add_map_command(app);
  kinloop::add_export_command(app);
  kinloop::add_mesh_command(app);
  kinloop::add_help_command(app);
  kinloop::add_version_command(app);
  const std::vector<std::string> words(argv + 1, argv + argc);
  kinloop::find_command(app,
                        words);  // for an unknown command CLI11 only says that a command is missing
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    throw kinloop::UsageError(kinloop::explain_parse_error(error, app, words));
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  kinloop::retain_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is an error like a full disk
  cv::setNumThreads(1);           // only parallel_for and the executor start threads
  set_up_log();
  try {
    auto words = kinloop::join_viewer_address({argv, argv + argc});
    std::vector<char*> joined;
    for (std::string& word : words) joined.push_back(word.data());
    return static_cast<int>(run(static_cast<int>(joined.size()), joined.data()));
  } catch (const kinloop::UsageError& error) {
    kinloop::log::error("{}", error.what());
    return static_cast<int>(ExitCode::kWrongUse);
  } catch (const kinloop::InputErrorWithHint& error) {
    kinloop::log::error("{}", error.what());
    fmt::print(stderr, "{}", error.hint());
    return static_cast<int>(ExitCode::kBadInput);
  } catch (const kinloop::InputError& error) {
    kinloop::log::error("{}", error.what());
    return static_cast<int>(ExitCode::kBadInput);
  } catch (const std::bad_alloc&) {
    kinloop::log::error("out of memory; try a larger --set dense.voxel_m or a shorter sequence");
    return static_cast<int>(ExitCode::kBadInput);
  } catch (const std::exception& error) {
    kinloop::log::error("internal error: {} (please report it)", error.what());
    return 1;
  }
}
