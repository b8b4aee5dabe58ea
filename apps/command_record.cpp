// kinloop record: any source, a live camera above all, to a folder in TUM layout.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/commands.hpp"
#include "apps/common_options.hpp"
#include "apps/interrupt.hpp"
#include "apps/open_source.hpp"
#include "apps/recorder.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"
#include "kinloop/base/options.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/stopwatch.hpp"

namespace kinloop {
namespace {

struct RecordArguments {
  std::string source;
  std::filesystem::path output;
  std::string camera, topics;
  size_t frames = 0;
  double seconds = 0;
  int threads = hardware_threads();
  std::vector<std::string> assignments;
};

SourceRequest request_of(const RecordArguments& arguments) {
  SourceRequest request;
  request.sequence = arguments.source;
  if (!arguments.camera.empty()) request.camera = arguments.camera;
  if (!arguments.topics.empty()) request.topics = arguments.topics;
  request.kinect = with_assignments(KinectOptions{}, arguments.assignments);
  request.threads = arguments.threads;
  return request;
}

void record(const RecordArguments& arguments) {
  const auto source = open_source(request_of(arguments));
  Recorder recorder(arguments.output, source->camera(), arguments.threads);
  catch_interrupts();
  const Stopwatch watch;
  size_t frames = 0;
  while (!interrupted()) {
    auto frame = source->next();
    if (!frame) break;
    recorder.add(std::move(*frame));
    ++frames;
    const bool enough = (arguments.frames > 0 && frames >= arguments.frames) ||
                        (arguments.seconds > 0 && watch.wall_s() >= arguments.seconds);
    if (enough) break;
  }
  recorder.finish(source->info().ground_truth);
  const size_t lost = source->skipped().size();
  if (lost > 0) log::warn("{} images were lost; the first: {}", lost, source->skipped().front().reason);
  fmt::print("{} frames in {} ({:.1f} a second, at most {} waiting to be written)\n", frames,
             arguments.output.string(), static_cast<double>(frames) / watch.wall_s(),
             recorder.most_waiting());
}

}  // namespace

void add_record_command(CLI::App& app) {
  auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command =
      app.add_subcommand("record", "Record a camera, or any other source, as a folder in TUM layout");
  command->add_option("SOURCE", arguments->source, "kinect1, kinect2, a .bag file, a folder, sim:room")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the sequence")->required();
  command->add_option("--camera", arguments->camera, "camera.yaml or preset, as for kinloop run");
  command->add_option("--topics", arguments->topics, "of a bag: COLOR,DEPTH[,CAMERA_INFO]");
  command->add_option("--frames", arguments->frames, "stop after this many frames");
  command->add_option("--seconds", arguments->seconds, "stop after this time")->check(CLI::PositiveNumber);
  add_threads_option(*command, arguments->threads, "threads that compress images");
  add_set_option(*command, arguments->assignments, "change an option of the camera, key=value");
  KinectOptions defaults;
  command->footer(
      "Ctrl-C ends the recording. Depth is registered to colour, in 1/5000 m.\nOptions for --set:\n" +
      options_help(option_entries(defaults)));
  command->callback([arguments] { record(*arguments); });
}

}  // namespace kinloop
