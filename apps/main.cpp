// The kinloop program: parses the command line, runs one command, and turns exceptions into one line and an
// exit code.

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "apps/run/run_viewer.hpp"
#include "apps/shared/command_line/command_line.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/version.hpp"
#include "apps/shared/terminal/failure.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/escaped.hpp"
#include "session/process.hpp"

namespace {

using kinloop::ExitCode;

constexpr const char* kExitCodes =
    R"(Exit codes: 0 done; 1 internal error; 2 wrong use; 3 bad input, or results that could not be written;
4 tracking lost and not regained; 5 kinloop batch found a difference; 129, 130, 143 ended by SIGHUP, Ctrl-C,
SIGTERM (the results of a run are written); 141 the reader of standard output is gone. See docs/reliability.md.)";

/// The text of a message.
class MessageText : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    const std::string text = kinloop::escaped({message.payload.data(), message.payload.size()});
    line.append(text.data(), text.data() + text.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<MessageText>();
  }
};

/// Sends log messages to standard error, each on one line; results go to standard output.
void set_up_log() {
  auto logger = spdlog::stderr_color_st("kinloop");
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<MessageText>('*').set_pattern("%^%l:%$ %*");
  logger->set_formatter(std::move(formatter));
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
  kinloop::add_share_command(app);
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
  kinloop::add_plan_command(app);
  kinloop::add_reproduce_command(app);
  const std::vector<std::string> words(argv + 1, argv + argc);
  kinloop::add_batch_command(app, words);
  kinloop::add_help_command(app);
  kinloop::add_version_command(app);
  app.footer(kExitCodes);  // not before: commands would inherit it
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

/// Returns the exit code after reporting what could not be printed. A reader that has seen enough (head)
/// needs no message.
ExitCode standard_output_failed(int error) {
  if (error == EPIPE) return ExitCode::kOutputClosed;
  kinloop::tell_error_code("output");
  kinloop::log::error("standard output: cannot be written ({}); the results in files are complete",
                      std::generic_category().message(error));
  return ExitCode::kBadInput;
}

ExitCode report(const std::exception& exception) {
  const auto* system = dynamic_cast<const std::system_error*>(&exception);
  if (system != nullptr && std::ferror(stdout) != 0) return standard_output_failed(system->code().value());
  const kinloop::Failure failure = kinloop::describe_failure(exception);
  kinloop::tell_error_code(failure.code);
  kinloop::log::error("{}", failure.message);
  std::fputs(failure.hint.c_str(), stderr);
  return failure.exit_code;
}

ExitCode run_and_report(int argc, char** argv) {
  try {
    kinloop::require_stack();
    auto words = kinloop::join_viewer_address({argv, argv + argc});
    std::vector<char*> joined;
    for (std::string& word : words) joined.push_back(word.data());
    const ExitCode exit_code = run(static_cast<int>(joined.size()), joined.data());
    const int error = kinloop::flush_standard_output();
    return exit_code == ExitCode::kDone && error != 0 ? standard_output_failed(error) : exit_code;
  } catch (const kinloop::Interrupted& interrupted) {
    return kinloop::exit_code_of_signal(interrupted.signal());
  } catch (const std::exception& error) {
    return report(error);
  }
}

/// Whether an allocation of this thread has failed. An exception that leaves a noexcept function of a
/// library, as when libstdc++ lists a folder, is unknown to the terminate handler.
thread_local bool memory_ran_out = false;

/// What ends the program where an exception cannot be caught, as in the destructors of libraries that
/// allocate.
[[noreturn]] void end_by_uncaught_exception() {
  try {
    if (const std::exception_ptr exception = std::current_exception()) std::rethrow_exception(exception);
    if (memory_ran_out) throw std::bad_alloc();
  } catch (const std::bad_alloc&) {
    kinloop::tell_error_code("memory");
    std::fputs("error: out of memory\n", stderr);
    std::_Exit(static_cast<int>(ExitCode::kBadInput));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: internal error: %s (please report it)\n", error.what());
  } catch (...) {
  }
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(end_by_uncaught_exception);
  std::set_new_handler([] {
    memory_ran_out = true;
    throw std::bad_alloc();
  });
  kinloop::reserve_standard_descriptors();
  kinloop::retain_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is an error like a full disk
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away must not end a run before its results are written
  try {
    cv::setNumThreads(1);  // only parallel_for and the executor start threads
    set_up_log();
    return static_cast<int>(run_and_report(argc, argv));
  } catch (const std::bad_alloc&) {  // before the log is set up, or while a failure is reported
    kinloop::tell_error_code("memory");
    std::fputs("error: out of memory\n", stderr);
    return static_cast<int>(ExitCode::kBadInput);
  }
}
