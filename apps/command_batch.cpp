// kinloop batch: whole datasets, on one or many machines. The work is done by the Python package
// kinloop.batch, which is started in place of this process; here are its options, for --help and what is made
// from it.

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr int kMostWorkers = 10'000;

/// Beside the program: PREFIX/bin/kinloop and PREFIX/share/kinloop/batch; the build tree has the same places.
std::filesystem::path batch_package(const std::filesystem::path& program) {
  auto package = program.parent_path().parent_path() / "share/kinloop/batch";
  if (!std::filesystem::exists(package / "__main__.py")) {
    throw InputError(
        fmt::format("{}: kinloop batch is not installed there; install kinloop again, with its folder share",
                    package.string()));
  }
  return package;
}

/// Replaces this process by `python3 PACKAGE WORDS...`, which finds the program in KINLOOP_PROGRAM.
[[noreturn]] void start_batch(std::vector<std::string> words) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe");
  words.insert(words.begin(), {"python3", batch_package(program).string()});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  setenv("KINLOOP_PROGRAM", program.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): no other thread is running
  execvp(arguments.front(), arguments.data());
  throw InputError(
      "kinloop batch needs Python 3.9 or newer, and there is no python3: apt install python3 python3-yaml");
}

/// An option that Python reads; here it is checked and described only.
void describe_option(CLI::App& command, const std::string& name, const std::string& type,
                     const std::string& text, const CLI::Validator& check = {}) {
  command
      .add_option_function<std::string>(
          name, [](const std::string&) {}, text)
      ->type_name(type)
      ->check(check);
}

void describe_argument(CLI::App& command, const std::string& name, const std::string& text) {
  command
      .add_option_function<std::string>(
          name, [](const std::string&) {}, text)
      ->required();
}

void describe_quiet(CLI::App& command) {
  command.add_flag_function(
      "-q,--quiet", [](int64_t) {}, "print only results, warnings and errors");
}

void describe_suite_options(CLI::App& command) {
  describe_option(command, "-o,--output", "DIR", "folder of the results (default: results)");
  describe_option(command, "--program", "FILE", "another kinloop to run (default: this one)");
}

void add_batch_commands(CLI::App& batch) {
  CLI::App* plan =
      batch.add_subcommand("plan", "Write the list of runs, and scripts for Slurm and Kubernetes");
  describe_argument(*plan, "SUITE", "YAML file of sequences and variants");
  describe_suite_options(*plan);
  describe_option(*plan, "--shards", "N", "parts to divide the runs into (default: 100)",
                  whole_number(1, kMostWorkers));

  CLI::App* shard = batch.add_subcommand("shard", "Do one part of a plan");
  describe_argument(*shard, "SHARD", "which part of how many, e.g. 3/100");
  describe_argument(*shard, "RESULTS", "folder of the results of kinloop batch plan");
  describe_option(*shard, "--workers", "N", "runs at a time (default: 1)", whole_number(1, kMostWorkers));

  CLI::App* table =
      batch.add_subcommand("table", "Write the tables and the page of a folder of results again");
  describe_argument(*table, "RESULTS", "folder of results");

  CLI::App* verify = batch.add_subcommand("verify", "Repeat a sample of finished runs and compare the bytes");
  describe_argument(*verify, "RESULTS", "folder of results");
  describe_option(*verify, "--sample", "N", "number of runs to repeat (default: 10)",
                  whole_number(1, 1'000'000));
  describe_option(*verify, "--seed", "N", "of the choice of runs (default: 1)",
                  whole_number(0, 1'000'000'000));

  CLI::App* compare =
      batch.add_subcommand("compare", "Compare two batches; exit code 5 if the second is worse");
  describe_argument(*compare, "FIRST", "folder of results, or its runs.csv");
  describe_argument(*compare, "SECOND",
                    "the same of the other version, with the same sequences and variants");
  describe_option(*compare, "--max-ate-ratio", "RATIO",
                  "allowed geometric mean of the ratios of ATE, if they are significant (default: 1.05)",
                  kinloop::number(0, 1000));
  describe_option(*compare, "--max-sequence-ratio", "RATIO",
                  "allowed ratio of any one sequence (default: 1.5)", kinloop::number(0, 1'000'000));
  describe_option(*compare, "--max-failures", "N",
                  "allowed sequences that fail in the second only (default: 0)", whole_number(0, 1'000'000));
  describe_option(*compare, "--max-cpu-ratio", "RATIO", "allowed ratio of CPU time, 0 = any (default: 0)",
                  kinloop::number(0, 1000));

  for (CLI::App* command : {plan, shard, table, verify, compare}) describe_quiet(*command);
}

}  // namespace

void add_batch_command(CLI::App& app, const std::vector<std::string>& words) {
  CLI::App* command =
      app.add_subcommand("batch", "Run whole datasets with variants on many cores or machines");
  command->add_option_function<std::string>(
      "SUITE", [](const std::string&) {}, "YAML file of sequences and variants; see docs/batch.md");
  describe_suite_options(*command);
  describe_option(*command, "--workers", "N", "runs at a time on this machine (default: number of cores)",
                  whole_number(1, kMostWorkers));
  describe_option(*command, "--scheduler", "tcp://HOST:PORT", "Dask scheduler whose workers do the runs");
  describe_quiet(*command);
  add_batch_commands(*command);
  command->footer(
      R"(Finished runs are never repeated: after Ctrl-C, a crash or with more sequences, run the same command again.

Examples:
  kinloop batch suite.yaml -o results --workers 4
  kinloop batch plan suite.yaml -o results --shards 50 && sbatch results/slurm.sh
  kinloop batch compare results_before results_now)");
  command->callback([command, words] {
    if (command->get_subcommands().empty() && command->count("SUITE") == 0)
      throw UsageError("kinloop batch: SUITE is missing; see kinloop batch --help");
    start_batch({words.begin() + 1, words.end()});
  });
}

}  // namespace kinloop
