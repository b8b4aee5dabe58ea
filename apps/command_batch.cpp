// kinloop batch: whole datasets, on one or many machines. Options, help and work are those of the Python
// package kinloop.batch, which is started in place of this process.

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/files/python_files.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

void start_batch(std::vector<std::string> words) {
  words.insert(words.begin(), {"python3", python_file("batch/__main__.py").parent_path().string()});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread is running
  setenv("KINLOOP_PROGRAM", own_program().c_str(), 1);
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
