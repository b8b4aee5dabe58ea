#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/map/compare_maps.hpp"
#include "apps/map/map_commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "dense/files/ply.hpp"
#include "kinloop/core/text/json.hpp"
#include "session/store/command_files.hpp"

namespace kinloop {
namespace {

struct DiffArguments {
  MergeRequest maps;
  std::filesystem::path output = "diff.ply";
  bool as_json = false;
  bool quiet = false;
};

std::string text_of(const MapDifference& difference, const FileFrame& frame) {
  if (difference.objects.empty()) return "no object is gone, added or moved\n";
  const auto place = [&](const Eigen::Vector3d& p_world) {
    const Eigen::Vector3f p = frame.to_file(p_world.cast<float>());
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", p.x(), p.y(), p.z());
  };
  std::string text;
  for (const ChangedObject& object : difference.objects) {
    text += fmt::format("{:6} {:5.2f} m²  at {}", to_string(object.change), object.surface_m2,
                        place(object.center_m));
    if (object.change == ObjectChange::kMoved) {
      text += fmt::format(", by {:.2f} m to {}", (object.moved_to_m - object.center_m).norm(),
                          place(object.moved_to_m));
    }
    text += '\n';
  }
  return text;
}

void diff(const DiffArguments& arguments) {
  require_outputs({.inputs = inputs_of(arguments.maps), .outputs = {{"-o", arguments.output}}});
  install_interrupt_handler();
  const Progress progress = interruptible(make_progress_bar(arguments.quiet || arguments.as_json));
  const ComparedMaps compared = compare_maps(arguments.maps, progress);
  const MapDifference& difference = compared.difference;
  const FileFrame frame = compared.file_frame();
  write_ply(arguments.output, color_difference(compared.before, compared.after, difference), frame);
  if (arguments.as_json) {
    nlohmann::json numbers = to_json(difference, frame.T_file_world().rotation);
    numbers["cloud"] = arguments.output.string();
    fmt::print("{}\n", json_text(numbers, 2));
  } else if (!arguments.quiet) {
    fmt::print(message_stream(arguments.output), "{}{}: red is gone, green was added\n",
               text_of(difference, frame), arguments.output.string());
  }
}

}  // namespace

void add_map_diff_command(CLI::App& map) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* command = map.add_subcommand(
      "diff",
      "Compare two maps of one place: what is gone in B, was added or was moved, as a cloud and a list");
  add_map_arguments(*command, arguments->maps);
  command->add_option("-o,--output", arguments->output, "cloud of both: red is gone, green was added")
      ->capture_default_str();
  command->add_flag("--json", arguments->as_json, "print the list as JSON");
  add_quiet_option(*command, arguments->quiet);
  command->footer(
      "The maps are joined as by 'kinloop map merge'. Something counts as gone if B saw\n"
      "through its place; where B did not look, nothing is said. Changes of less than\n"
      "some 5 cm in depth or 300 cm² are not found.\n\n"
      "Examples:\n"
      "  kinloop map diff monday tuesday -o diff.ply\n"
      "  kinloop map diff monday tuesday --json");
  command->callback([arguments] { diff(*arguments); });
}

}  // namespace kinloop
