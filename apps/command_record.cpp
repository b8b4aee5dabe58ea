// kinloop record: records any source, usually a live camera, to a folder in TUM layout or an MCAP file.

#include <exception>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/files/recorder.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "drivers/datasets/tum_writer.hpp"
#include "drivers/kinect2/kinect2_raw.hpp"
#include "drivers/live/paced_source.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/source/open_frame_source.hpp"
#include "session/store/command_files.hpp"

namespace kinloop {
namespace {

struct RecordArguments {
  std::string source, chosen;
  std::filesystem::path output;
  CameraOptions camera;
  std::string topics;
  size_t frames = 0;
  double seconds = 0, pace_hz = 0;
  bool raw = false;
  int threads = hardware_threads();
  std::vector<std::string> assignments;
};

SourceRequest request_of(const RecordArguments& arguments) {
  SourceRequest request;
  request.sequence = arguments.source;
  request.chosen = arguments.chosen;
  set_camera(request, arguments.camera);
  if (!arguments.topics.empty()) request.topics = arguments.topics;
  request.kinect = with_assignments(KinectOptions{}, arguments.assignments);
  request.threads = arguments.threads;
  request.stop = interrupted;
  return request;
}

/// What the command reads, and the recording that it writes.
CommandFiles command_files(const RecordArguments& arguments) {
  CommandFiles files{.inputs = {arguments.camera.camera}};
  add_sequence_input(files, arguments.source, arguments.chosen);
  if (arguments.output.extension() == ".mcap") {
    files.outputs = {{"-o", arguments.output}};
  } else {
    files.results = {{{"-o", arguments.output}, tum_file_names()}};
  }
  return files;
}

/// Returns whether the requested number of frames or seconds is reached.
bool limit_reached(const RecordArguments& arguments, size_t frames, const Stopwatch& watch) {
  return (arguments.frames > 0 && frames >= arguments.frames) ||
         (arguments.seconds > 0 && watch.wall_s() >= arguments.seconds);
}

/// Records a Kinect 2's raw packets for libfreenect2's replay device.
void record_raw(const RecordArguments& arguments) {
  if (arguments.source != "kinect2")
    throw UsageError("--raw requires a Kinect 2: kinloop record kinect2 --raw");
  install_interrupt_handler();
  const Stopwatch watch;
  const auto recording =
      record_kinect2_raw(with_assignments(KinectOptions{}, arguments.assignments), arguments.output,
                         [&](const RawPacketCounts& so_far) {
                           return interrupted() || limit_reached(arguments, so_far.depth, watch);
                         });
  print_text(fmt::format("{} depth and {} colour packets in {}, {} lost\n", recording.depth, recording.color,
                         arguments.output.string(), recording.lost));
}

void record(const RecordArguments& arguments) {
  if (arguments.raw) return record_raw(arguments);
  require_outputs(command_files(arguments));
  auto source = open_frame_source(request_of(arguments));
  const PacedSource* paced = nullptr;
  if (arguments.pace_hz > 0) {
    auto at_pace = std::make_unique<PacedSource>(std::move(source), arguments.pace_hz);
    paced = at_pace.get();
    source = std::move(at_pace);
  }
  Recorder recorder(arguments.output, source->camera(), arguments.threads);
  install_interrupt_handler();
  const Stopwatch watch;
  size_t frames = 0;
  std::exception_ptr failure;  // of the source; what was recorded before is completed
  while (!interrupted() && !limit_reached(arguments, frames, watch)) {
    std::optional<Frame> frame;
    try {
      frame = source->next();
    } catch (const InputError&) {
      failure = std::current_exception();
    }
    if (!frame) break;
    recorder.add(std::move(*frame));
    ++frames;
  }
  if (frames == 0 && failure) std::rethrow_exception(failure);
  recorder.finish(source->info().ground_truth);
  if (paced != nullptr) fmt::print("{} frames were dropped\n", paced->dropped());
  const size_t lost = source->skipped().size();
  if (lost > 0) log::warn("images lost: {}; the first: {}", lost, source->skipped().front().reason);
  print_text(fmt::format("{} frames in {} ({:.1f} per second, at most {} queued for writing)\n", frames,
                         arguments.output.string(), static_cast<double>(frames) / watch.wall_s(),
                         recorder.max_queued()));
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

void add_record_command(CLI::App& app) {
  auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command = app.add_subcommand(
      "record", "Record a camera or any other source as a folder in TUM layout, or as one MCAP file");
  command
      ->add_option("SOURCE", arguments->source,
                   "kinect1, kinect2, openni2, realsense, orbbec, oak, or any other source of kinloop run")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the sequence, or FILE.mcap")->required();
  add_sequence_option(*command, arguments->chosen);
  add_camera_options(*command, arguments->camera);
  command->add_option("--topics", arguments->topics, "topics of a bag: COLOR,DEPTH[,CAMERA_INFO]");
  command->add_option("--frames", arguments->frames, "stop after this many frames");
  command->add_option("--seconds", arguments->seconds, "stop after this time")->check(positive_number());
  command->add_option("--pace", arguments->pace_hz, "deliver frames at this rate, as a camera does, Hz")
      ->check(positive_number());
  command->add_flag("--raw", arguments->raw, "record the undecoded packets of a Kinect 2");
  add_threads_option(*command, arguments->threads, "number of threads that compress images");
  add_set_option(*command, arguments->assignments, "set a camera option, key=value");
  KinectOptions defaults;
  command->footer(
      "Ctrl-C ends the recording. Depth is registered to colour, in 1/5000 m.\nOptions for --set:\n" +
      options_help(option_entries(defaults)));
  command->callback([arguments] { record(*arguments); });
}

}  // namespace kinloop
