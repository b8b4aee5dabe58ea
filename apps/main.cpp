// The kinloop program: parses the command line, runs one command, turns exceptions into one line and an exit
// code.

#include <algorithm>
#include <csignal>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "apps/commands.hpp"
#include "apps/memory.hpp"
#include "apps/show_run.hpp"
#include "apps/version.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/base/nearest_word.hpp"

namespace {

using kinloop::ExitCode;

void set_up_log() {
  // Results go to standard output; what is said about the work goes to standard error.
  auto logger = spdlog::stderr_color_st("kinloop");
  logger->set_pattern("%^%l:%$ %v");
  spdlog::set_default_logger(logger);
}

/// CLI11 says of a word that is no command only that a command is missing.
void require_known_commands(const CLI::App& program, std::span<char*> words) {
  const CLI::App* app = &program;
  for (const std::string word : words) {
    const auto commands = app->get_subcommands([](const CLI::App*) { return true; });
    if (commands.empty() || word.starts_with('-')) return;
    std::vector<std::string> names;
    for (const CLI::App* command : commands) names.push_back(command->get_name());
    const auto named = std::find(names.begin(), names.end(), word);
    if (named == names.end()) {
      const std::string guess = kinloop::did_you_mean(word, names, word.size() / 2);
      throw kinloop::UsageError(
          fmt::format("{} knows no command '{}'{}; see --help", app->get_name(), word, guess));
    }
    app = commands[static_cast<size_t>(named - names.begin())];
  }
}

ExitCode run(int argc, char** argv) {
  CLI::App app(
      "kinloop: a camera trajectory and a coloured 3D map from a Kinect-class camera, on a CPU.\n"
      "Start with: kinloop run sim:room -o out    (then open out/report.html)",
      "kinloop");
  app.set_version_flag("--version", kinloop::version_text());
  app.require_subcommand(1);
  ExitCode exit_code = ExitCode::kDone;
  kinloop::add_run_command(app, exit_code);
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
  require_known_commands(app, std::span(argv, static_cast<size_t>(argc)).subspan(1));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kWrongUse;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  kinloop::keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error like a full disk
  cv::setNumThreads(1);           // threads are parallel_for's and the executor's to hand out
  set_up_log();
  try {
    auto words = kinloop::with_viewer_address({argv, argv + argc});
    std::vector<char*> joined;
    for (std::string& word : words) joined.push_back(word.data());
    return static_cast<int>(run(static_cast<int>(joined.size()), joined.data()));
  } catch (const kinloop::UsageError& error) {
    kinloop::log::error("{}", error.what());
    return static_cast<int>(ExitCode::kWrongUse);
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
