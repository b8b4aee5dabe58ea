// kinloop simulate: renders a simulated RGB-D camera moving through a room and writes a sequence in TUM
// layout.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "drivers/datasets/tum_writer.hpp"
#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "session/store/command_files.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {
namespace {

struct SimulateArguments {
  std::string scene = "room";
  std::filesystem::path path;
  std::filesystem::path output;
  std::string noise = "kinect", sensor = "kinect1";
  uint64_t seed = 1;
  std::string frames, fps, size;      ///< as given; empty if not given
  std::vector<std::string> settings;  ///< key=value
  int threads = hardware_threads();
  bool quiet = false;
};

SimulationOptions chosen_options(const SimulateArguments& arguments) {
  SimulationOptions options;
  if (arguments.noise == "none") options.remove_noise();
  std::vector<std::string> settings{"sensor=" + arguments.sensor};
  if (!arguments.frames.empty()) settings.push_back("frames=" + arguments.frames);
  if (!arguments.fps.empty()) settings.push_back("fps=" + arguments.fps);
  if (!arguments.size.empty()) {
    const size_t times = arguments.size.find('x');
    if (times == std::string::npos) {
      throw UsageError(fmt::format("--size: '{}' is not WIDTHxHEIGHT, e.g. 320x240", arguments.size));
    }
    settings.push_back("width=" + arguments.size.substr(0, times));
    settings.push_back("height=" + arguments.size.substr(times + 1));
  }
  settings.insert(settings.end(), arguments.settings.begin(), arguments.settings.end());
  return with_assignments(options, settings);
}

/// Writes where movers are seen, as movers/STAMP.png: a truth to compare with, not a mask that a run applies.
void write_mover_mask(const std::filesystem::path& folder, const SimulatedSource& source, size_t index) {
  const int64_t stamp_ns = source.info().ground_truth[index].stamp_ns;
  write_png(folder / "movers" / (format_stamp(stamp_ns) + ".png"), source.mover_mask(index));
}

void simulate(const SimulateArguments& arguments, const SimulationOptions& options) {
  std::optional<std::filesystem::path> path;
  if (!arguments.path.empty()) path = arguments.path;
  require_outputs({.inputs = {arguments.path}, .results = {{{"-o", arguments.output}, tum_file_names()}}});
  require_no_sequence(arguments.output);
  const std::string spec = fmt::format("sim:{}:{}", arguments.scene, arguments.seed);
  const auto source = make_simulated_source(spec, options, arguments.threads, path);
  TumWriter writer(arguments.output, source->device());
  if (source->has_movers()) require_writable_folder(arguments.output / "movers");
  const Progress progress = make_progress_bar(arguments.quiet);
  const size_t frames = source->info().frames;
  for (size_t i = 0; i < frames; ++i) {
    writer.append(source->device_frame(i));
    if (source->has_movers()) write_mover_mask(arguments.output, *source, i);
    report(progress, "rendering", i + 1, frames);
  }
  writer.finish(source->info().ground_truth);
  if (!arguments.quiet) print_text(fmt::format("{} frames in {}\n", frames, arguments.output.string()));
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Render what an RGB-D camera would see when carried through a furnished room, and write it "
      "as a sequence in TUM\nlayout with ground truth. Without --path: a hand-held loop "
      "of about 18 s, as in `kinloop run sim:room`.");
  command->add_option("scene", arguments->scene, "the scene")->required()->check(one_of({"room"}));
  command->add_option("-o,--output", arguments->output, "folder for the sequence")->required();
  command->add_option("--path", arguments->path,
                      "trajectory to render along (TUM format); the room is built around it");
  command
      ->add_option("--sensor", arguments->sensor,
                   "kinect1: depth registered to colour; kinect2 (time of flight) and realsense (stereo): a "
                   "depth camera\nof its own")
      ->check(one_of(names_of<SimulatedSensor>()))
      ->capture_default_str();
  command->add_option("--noise", arguments->noise, "kinect: the noise of the sensor; none: an ideal sensor")
      ->check(one_of({"kinect", "none"}))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "seed of the room and of the noise")->capture_default_str();
  command->add_option("--frames", arguments->frames, "stop after this many frames");
  command->add_option("--fps", arguments->fps,
                      "frames per second (default: the timestamps of --path, or 30)");
  command->add_option("--size", arguments->size,
                      "size of the colour image, WIDTHxHEIGHT (640x480; kinect2: 960x540)");
  add_set_option(*command, arguments->settings, "set any option below, key=value; overrides the flags");
  add_threads_option(*command, arguments->threads, "number of rendering threads");
  add_quiet_option(*command, arguments->quiet);
  SimulationOptions defaults;
  command->footer("Options for --set:\n" + options_help(option_entries(defaults)));
  command->callback([arguments] { simulate(*arguments, chosen_options(*arguments)); });
}

}  // namespace kinloop
