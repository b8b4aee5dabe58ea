#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/map/map_commands.hpp"
#include "apps/map/withdraw_from_file.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {
namespace {

struct WithdrawArguments {
  std::filesystem::path map, output;
  std::vector<std::string> loops;
  bool quiet = false;
};

void withdraw(const WithdrawArguments& arguments) {
  const auto [withdrawn, left, keyframes, components] = withdraw_from_file(
      {map_file_of(arguments.map), arguments.output, arguments.loops}, make_progress_bar(arguments.quiet));
  if (arguments.quiet) return;
  fmt::print(message_stream(arguments.output),
             "{} loops withdrawn, {} left; {} keyframes in {} component(s), in {}\n", withdrawn, left,
             keyframes, components, arguments.output.string());
}

}  // namespace

void add_map_withdraw_command(CLI::App& map) {
  auto arguments = std::make_shared<WithdrawArguments>();
  CLI::App* command = map.add_subcommand("withdraw", "Take false loops out of a map and solve it again");
  add_map_argument(*command, arguments->map);
  command
      ->add_option("--loop", arguments->loops,
                   "the stamps of its two keyframes, s, as 'loops' in run.json lists them; may be repeated")
      ->type_name("STAMP_A,STAMP_B")
      ->required()
      ->allow_extra_args(false);
  command->add_option("-o,--output", arguments->output, "the map file to write")->required();
  add_quiet_option(*command, arguments->quiet);
  command->footer(
      "Components that only these loops joined are parted, and the landmarks that only they\n"
      "identified are split. Several loops often join the same places: name all that are\n"
      "false. 'kinloop view' shows each loop with its pictures, and this command for it.");
  command->callback([arguments] { withdraw(*arguments); });
}

}  // namespace kinloop
