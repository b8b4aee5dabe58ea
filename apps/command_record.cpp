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
#include "kinloop/sensor/kinect2_raw.hpp"
#include "kinloop/sensor/paced_source.hpp"

namespace kinloop {
namespace {

struct RecordArguments {
  std::string source;
  std::filesystem::path output;
  std::string camera, topics;
  size_t frames = 0;
  double seconds = 0, pace_hz = 0;
  bool raw = false;
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

/// Whether there are as many frames, or seconds, as the user wanted.
bool enough(const RecordArguments& arguments, size_t frames, const Stopwatch& watch) {
  return (arguments.frames > 0 && frames >= arguments.frames) ||
         (arguments.seconds > 0 && watch.wall_s() >= arguments.seconds);
}

/// A Kinect 2's packets as they come, for libfreenect2's replay.
void record_raw(const RecordArguments& arguments) {
  if (arguments.source != "kinect2")
    throw UsageError("--raw records a Kinect 2's packets: kinloop record kinect2 --raw");
  catch_interrupts();
  const Stopwatch watch;
  const auto recording = record_kinect2_raw(
      with_assignments(KinectOptions{}, arguments.assignments), arguments.output,
      [&](const RawRecording& so_far) { return interrupted() || enough(arguments, so_far.depth, watch); });
  fmt::print("{} depth and {} colour packets in {}, {} lost\n", recording.depth, recording.color,
             arguments.output.string(), recording.lost);
}

void record(const RecordArguments& arguments) {
  if (arguments.raw) return record_raw(arguments);
  auto source = open_source(request_of(arguments));
  const PacedSource* paced = nullptr;
  if (arguments.pace_hz > 0) {
    auto at_pace = std::make_unique<PacedSource>(std::move(source), arguments.pace_hz);
    paced = at_pace.get();
    source = std::move(at_pace);
  }
  Recorder recorder(arguments.output, source->camera(), arguments.threads);
  catch_interrupts();
  const Stopwatch watch;
  size_t frames = 0;
  while (!interrupted()) {
    auto frame = source->next();
    if (!frame) break;
    recorder.add(std::move(*frame));
    ++frames;
    if (enough(arguments, frames, watch)) break;
  }
  recorder.finish(source->info().ground_truth);
  if (paced != nullptr) fmt::print("{} frames were not taken in time\n", paced->dropped());
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
  command->add_option("--seconds", arguments->seconds, "stop after this time")->check(above_zero());
  command->add_option("--pace", arguments->pace_hz, "frames come at this rate, as from a camera, Hz")
      ->check(above_zero());
  command->add_flag("--raw", arguments->raw, "of a Kinect 2: its packets, undecoded");
  add_threads_option(*command, arguments->threads, "threads that compress images");
  add_set_option(*command, arguments->assignments, "change an option of the camera, key=value");
  KinectOptions defaults;
  command->footer(
      "Ctrl-C ends the recording. Depth is registered to colour, in 1/5000 m.\nOptions for --set:\n" +
      options_help(option_entries(defaults)));
  command->callback([arguments] { record(*arguments); });
}

}  // namespace kinloop
