// kinloop help and kinloop version; and the output of plain kinloop.

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/shared/command_line/command_line.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/version.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr const char* kQuickStart =
    R"(kinloop computes the camera trajectory and a coloured 3D map from an RGB-D camera, on a CPU.

Getting started:
  kinloop run sim:room -o out                  map a sequence (here the built-in simulated room)
  kinloop view out                             view the map in a browser
  kinloop mesh out -o mesh.ply                 export a coloured mesh
  kinloop fetch tum/fr1_desk                   download a real sequence, then: kinloop run rgbd_dataset_freiburg1_desk
  kinloop record kinect1 -o my_room            record from your own camera

For all commands: kinloop --help. For one: kinloop help COMMAND.
)";

}  // namespace

void print_quick_start() {
  fmt::print("{}", kQuickStart);
}

void add_help_command(CLI::App& app) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("help", "Show the help of a command");
  command->add_option("COMMAND", *words, "e.g. run, or map merge (default: list all commands)");
  command->callback([&app, words] {
    const CLI::App& asked = find_command(app, *words);
    if (asked.get_name() == "batch") {
      words->push_back("--help");
      start_batch({words->begin() + 1, words->end()});
    }
    // CLI11 would print the help of the command that was called, which is this one.
    fmt::print("{}", asked.get_formatter()->make_help(&asked, full_name(asked), CLI::AppFormatMode::Normal));
  });
}

void add_version_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("version", "Show the version and the optional parts of this build");
  command->callback([] { fmt::print("{}\n", version_text()); });
}

}  // namespace kinloop
