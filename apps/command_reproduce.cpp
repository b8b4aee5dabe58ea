// kinloop reproduce: makes the tables and figures of "Kinect Based 3D Visual SLAM" anew, from data that is
// given or simulated.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/reproduce/chapters.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/text/json.hpp"
#include "session/process.hpp"
#include "session/store/command_files.hpp"

namespace kinloop {

Chapter data_chapter(ReproduceFolder& folder) {
  Chapter chapter;
  chapter.title = "Data";
  folder.sequence = folder.arguments.sequence;
  chapter.text = fmt::format("The sequence is {}.", folder.sequence);
  if (!folder.sequence.empty()) return chapter;
  folder.sequence = folder.at("room");
  chapter.text = "The sequence is the simulated room, as a Kinect 1 sees it.";
  run_program(chapter, {"simulate", "room", "-q", "-o", folder.sequence});
  return chapter;
}

namespace {

constexpr const char* kReproduceFooter = R"(
Runs features, vocab, calibrate and run, and writes reproduced.md (tables, pictures, the commands), figures.json and
the reports. Without data the simulated Kinect is used; that takes about three CPU minutes.

Examples:
  kinloop reproduce -o reproduced
  kinloop reproduce rgbd_dataset_freiburg1_room --images photos --stills kinect2_stills -o reproduced)";

void reproduce(const ReproduceArguments& arguments) {
  CommandFiles files{.results = {{{"-o", arguments.output}, {}}}};
  add_sequence_input(files, arguments.sequence);
  files.recordings.insert(files.recordings.end(), {arguments.images, arguments.stills});
  require_outputs(files);
  require_writable_folder(arguments.output);
  ReproduceFolder folder{arguments, {}};
  std::string page = fmt::format(
      "# \"Kinect Based 3D Visual SLAM\", reproduced\n\nBy `kinloop reproduce`, {}. The commands above each "
      "table produced it.\n",
      program_name());
  nlohmann::json figures;
  const auto add = [&](const Chapter& chapter) {
    page += fmt::format("\n{}", to_markdown(chapter));
    if (!chapter.figures.is_null()) figures[chapter.title] = chapter.figures;
    write_file(folder.at("reproduced.md"), page);
    write_file(folder.at("figures.json"), fmt::format("{}\n", json_text(figures, 2)));
  };
  add(data_chapter(folder));
  add(feature_chapter(folder));
  add(mapping_chapter(folder));
  add(vocabulary_chapter(folder));
  add(calibration_chapter(folder));
  print_text(fmt::format("{}\n", folder.at("reproduced.md")));
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "reproduce", "Reproduce the tables and figures of the paper Kinect Based 3D Visual SLAM");
  command->footer(kReproduceFooter);
  auto arguments = std::make_shared<ReproduceArguments>();
  command->add_option("SEQUENCE", arguments->sequence,
                      "a sequence, as for kinloop run (default: the simulated room)");
  command->add_option("-o,--output", arguments->output, "folder for the results")->capture_default_str();
  command->add_option(
      "--images", arguments->images,
      "images to train vocabularies on; the sequence is then held out (default: a simulated room)");
  command->add_option("--stills", arguments->stills,
                      "stills of a chessboard, or a folder with colour, ir and sync (default: drawn ones)");
  command->add_option("--board", arguments->board, "inner corners of the chessboard, columns x rows")
      ->capture_default_str();
  command->add_option("--square", arguments->square_m, "side of a square, m")
      ->check(positive_number())
      ->capture_default_str();
  command->callback([arguments] { reproduce(*arguments); });
}

}  // namespace kinloop
