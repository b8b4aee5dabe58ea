#pragma once
// Each command of the program registers itself as a subcommand; its callback does the work, prints its result
// on standard output and throws InputError or UsageError, which main turns into exit codes.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kinloop {

/// Exit codes of the command line contract; an interrupted run ends with 128 + the signal, as in a shell.
enum class ExitCode : int {
  kDone = 0,
  kInternalError = 1,
  kWrongUse = 2,
  kBadInput = 3,
  kTrackingLost = 4,
  kHungUp = 129,
  kInterrupted = 130,
  kOutputClosed = 141,
  kTerminated = 143
};

/// Returns the exit code of a program that a signal has ended, as shells tell it.
constexpr ExitCode exit_code_of_signal(int signal) {
  constexpr int kOfSignals = 128;
  return static_cast<ExitCode>(kOfSignals + signal);
}

/// Prints the most important commands; the output of plain `kinloop`.
void print_quick_start();

void add_help_command(CLI::App& app);
void add_version_command(CLI::App& app);
void add_run_command(CLI::App& app, ExitCode& exit_code);
void add_probe_command(CLI::App& app);
void add_eval_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_vocab_command(CLI::App& app);
void add_optimize_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_features_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_record_command(CLI::App& app);
void add_fetch_command(CLI::App& app);
void add_view_command(CLI::App& app);
void add_share_command(CLI::App& app);
void add_map_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_mesh_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_reproduce_command(CLI::App& app);

/// Replaces this process by `python3 PACKAGE WORDS...`, which finds the program in KINLOOP_PROGRAM. Throws
/// InputError if the package or Python is missing.
[[noreturn]] void start_batch(std::vector<std::string> words);

/// `words`: the command line, which kinloop batch passes on.
void add_batch_command(CLI::App& app, const std::vector<std::string>& words);

}  // namespace kinloop
