// kinloop help and kinloop version; and what kinloop alone prints.

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/command_line.hpp"
#include "apps/commands.hpp"
#include "apps/version.hpp"
#include "kinloop/base/errors.hpp"

namespace kinloop {
namespace {

constexpr const char* kFirstHelp =
    R"(kinloop makes a camera trajectory and a coloured 3D map from an RGB-D camera, on a CPU.

The five commands to know first:
  kinloop run sim:room -o out                  map a sequence (here the built-in simulated room)
  kinloop view out                             look at the map in a browser
  kinloop mesh out -o mesh.ply                 make a coloured mesh of it
  kinloop fetch tum/fr1_desk                   download a real sequence, then: kinloop run rgbd_dataset_freiburg1_desk
  kinloop record kinect1 -o my_room            record your own camera

All commands: kinloop --help. One of them: kinloop help COMMAND.
)";

}  // namespace

void print_first_help() {
  fmt::print("{}", kFirstHelp);
}

void add_help_command(CLI::App& app) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("help", "What a command does, and its options");
  command->add_option("COMMAND", *words, "e.g. run, or map merge; without: all commands");
  command->callback([&app, words] {
    const CLI::App& asked = command_in(app, *words);
    // CLI11 would give the help of the command that was called, which is this one.
    fmt::print("{}", asked.get_formatter()->make_help(&asked, full_name(asked), CLI::AppFormatMode::Normal));
  });
}

void add_version_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("version", "The version, and which optional parts are in this build");
  command->callback([] { fmt::print("{}\n", version_text()); });
}

}  // namespace kinloop
