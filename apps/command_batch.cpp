// kinloop batch: whole datasets, on one or many machines. Options, help and work are those of the Python
// package kinloop.batch, which is started in place of this process.

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/shared/commands.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

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

}  // namespace

void start_batch(std::vector<std::string> words) {
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

void add_batch_command(CLI::App& app, const std::vector<std::string>& words) {
  CLI::App* command =
      app.add_subcommand("batch", "Run whole datasets with variants on many cores or machines");
  command->set_help_flag();
  command->prefix_command();
  command->callback([words] { start_batch({words.begin() + 1, words.end()}); });
}

}  // namespace kinloop
