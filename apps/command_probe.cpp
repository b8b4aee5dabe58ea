// kinloop probe: says what a recording is and whether its depth makes sense, without mapping it.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/probe/sequence_statistics.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "session/input/checks/input_checker.hpp"
#include "session/source/open_frame_source.hpp"

namespace kinloop {
namespace {

constexpr size_t kLookedAt = 30;  // frames that are decoded

struct ProbeArguments {
  std::string sequence, chosen;
  CameraOptions camera;
  bool print_camera = false;
};

/// What is known of a recording. Stamps are of all frames, or only of those decoded.
struct Probed {
  std::string name, description;
  RgbdCamera camera;
  bool stamps_measured = true;
  bool metric_depth = false;
  std::vector<int64_t> stamps_ns;
  std::vector<double> depth_minus_color_s;
  std::vector<Frame> frames;
  SkippedFrames skipped;
  size_t truth = 0;
  Pairing pairing;
  std::string first_pair, worst_pair;  ///< "1.png with 2.png"; empty: not of single files
};

std::string text_of(const RecordedFrame& frame) {
  return fmt::format("{} with {}", frame.color.file.filename().string(),
                     frame.depth.file.filename().string());
}

void note_pairs(const RecordedSequence& sequence, Probed& probed) {
  const auto& frames = sequence.frames;
  probed.pairing = sequence.pairing;
  if (frames.empty() || !sequence.video.empty() || frames.front().color.size > 0) return;
  const auto apart_ns = [](const RecordedFrame& f) { return std::abs(f.depth_stamp_ns - f.stamp_ns); };
  const auto worst = std::max_element(
      frames.begin(), frames.end(), [&](const auto& a, const auto& b) { return apart_ns(a) < apart_ns(b); });
  probed.first_pair = text_of(frames.front());
  if (sequence.stamps_measured && apart_ns(*worst) > 0)
    probed.worst_pair = fmt::format("{}, {:+.1f} ms", text_of(*worst),
                                    1e-6 * static_cast<double>(worst->depth_stamp_ns - worst->stamp_ns));
}

void take_frames(FrameSource& source, Probed& probed) {
  while (probed.frames.size() < kLookedAt) {
    auto frame = source.next();
    if (!frame) break;
    probed.frames.push_back(std::move(*frame));
  }
  probed.skipped = source.skipped();
}

OpenedSequence read_folder(const SourceRequest& request) {
  OpenedSequence opened =
      read_sequence(request.sequence, request.camera, request.depth_scale, request.chosen);
  if (request.sensor) opened.camera.sensor = depth_sensor(*request.sensor, SensorOrigin::kCameraFile);
  return opened;
}

/// Decodes frames spread over the sequence; of a video, which can only be read in order, the first.
Probed probe_layout(const SourceRequest& request) {
  OpenedSequence opened = read_folder(request);
  RecordedSequence& sequence = opened.sequence;
  Probed probed;
  probed.name = opened.name;
  probed.description = describe(sequence, opened.camera);
  probed.camera = opened.camera;
  probed.stamps_measured = sequence.stamps_measured;
  probed.metric_depth = is_metric(sequence.depth_encoding);
  probed.truth = sequence.ground_truth.size();
  note_pairs(sequence, probed);
  for (const RecordedFrame& frame : sequence.frames) {
    probed.stamps_ns.push_back(frame.stamp_ns);
    probed.depth_minus_color_s.push_back(1e-9 * static_cast<double>(frame.depth_stamp_ns - frame.stamp_ns));
  }
  if (sequence.video.empty()) {
    const size_t step = std::max<size_t>(1, sequence.frames.size() / kLookedAt);
    std::vector<RecordedFrame> some;
    for (size_t i = 0; i < sequence.frames.size(); i += step) some.push_back(sequence.frames[i]);
    sequence.frames = std::move(some);
  }
  RecordedSource source(opened.name, std::move(sequence), opened.camera);
  take_frames(source, probed);
  return probed;
}

/// Any other source: only the first frames are known.
Probed probe_source(const SourceRequest& request) {
  const auto source = open_frame_source(request);
  Probed probed;
  probed.name = request.sequence;
  probed.description = fmt::format("{} frames", source->info().frames);
  probed.camera = source->camera();
  probed.truth = source->info().ground_truth.size();
  take_frames(*source, probed);
  for (const Frame& frame : probed.frames) probed.stamps_ns.push_back(frame.stamp_ns);
  return probed;
}

std::string lens_text(const PinholeCamera& lens) {
  return fmt::format("{} x {}, fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f}{}", lens.width, lens.height,
                     lens.fx, lens.fy, lens.cx, lens.cy, lens.has_distortion() ? ", distortion" : "");
}

std::string sensor_text(const DepthSensor& sensor) {
  const auto origin = [&] {
    if (sensor.origin == SensorOrigin::kCameraFile) return "named by the camera file or the user";
    return sensor.origin == SensorOrigin::kSource ? "known from the recording"
                                                  : "assumed; name it in camera.yaml if it is another";
  };
  const std::string kind(name_of(sensor.kind)), model(name_of(sensor.model));
  return fmt::format("{}: depth noise {:.1f} mm at 1 m, {:.1f} mm at 3 m ({})",
                     kind == model ? kind : fmt::format("{}, {}", kind, model), 1e3 * sensor.noise.sigma_m(1),
                     1e3 * sensor.noise.sigma_m(3), origin());
}

void print_pairs(const Probed& probed) {
  const Pairing& pairing = probed.pairing;
  if (!probed.first_pair.empty()) {
    const std::string rule = pairing.rule.empty() ? "as the files say" : pairing.rule;
    print_text(fmt::format("pairs      {}{}{}\n", rule, pairing.times.empty() ? "" : "; ", pairing.times));
    print_text(fmt::format("           the first: {}\n", probed.first_pair));
    if (!probed.worst_pair.empty())
      print_text(fmt::format("           farthest apart: {}\n", probed.worst_pair));
  }
  const std::string unpaired = unpaired_text(pairing);
  if (!unpaired.empty()) print_text(fmt::format("unpaired   {}\n", unpaired));
  if (pairing.by_order) tell_pairing(probed.name, pairing);
}

void print_times(const Probed& probed) {
  if (!probed.stamps_measured)
    return fmt::print("rate       none recorded, {:.6g} Hz assumed\n", probed.camera.fps);
  const auto rate = rate_statistics(probed.stamps_ns);
  if (!rate) return fmt::print("rate       too few frames\n");
  fmt::print("rate       {:.2f} Hz (median), jitter {:.1f} ms (95 %), {:.1f} s, {} gaps",
             1 / rate->median_interval_s, 1e3 * rate->jitter_s, rate->duration_s, rate->gaps);
  fmt::print("{}\n", rate->gaps > 0 ? fmt::format(", the longest {:.3f} s", rate->longest_gap_s) : "");
  const auto& lags_s = probed.depth_minus_color_s;
  if (std::all_of(lags_s.begin(), lags_s.end(), [](double lag_s) { return lag_s == 0; })) return;
  const Spread lag_s = spread_of(lags_s);
  fmt::print("depth time {:+.1f} ms after colour (median), {:+.1f} to {:+.1f} ms (5 % to 95 %)\n",
             1e3 * lag_s.median, 1e3 * lag_s.low, 1e3 * lag_s.high);
}

const char* registration_text(const std::optional<EdgeAlignment>& alignment) {
  switch (alignment ? judge_registration(*alignment) : Registration::kUnknown) {
    case Registration::kUnknown:
      return "unknown: too few edges of depth and colour agree";
    case Registration::kRegistered:
      return "yes: edges of depth and colour agree";
    case Registration::kShifted:
    case Registration::kScaled:
    case Registration::kMirrored:
      break;
  }
  return "no: see the warning";
}

/// Prints whether depth is registered, and warns where the frames contradict themselves. Throws InputError if
/// nothing useful can come of them.
void print_contradictions(const Probed& probed) {
  InputChecker checker(probed.camera, FrameOrder::kSpread);
  std::vector<InputWarning> found;
  const auto add = [&](std::vector<InputWarning> more) {
    found.insert(found.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  for (const Frame& frame : probed.frames) add(checker.observe(frame));
  add(checker.finish());
  fmt::print("registered {}\n", registration_text(checker.alignment()));
  std::fflush(stdout);
  for (const InputWarning& warning : found) {
    if (!warning.hopeless) log::warn("{}", text_of(warning));
  }
  for (const InputWarning& warning : found) {
    if (warning.hopeless) throw InputError(text_of(warning));
  }
}

void print_depth(const Probed& probed) {
  const auto [depth_m, share] = depth_statistics(probed.frames);
  fmt::print("depth      {:.2f} m (5 %), {:.2f} m (median), {:.2f} m (95 %); {:.0f} % of the pixels\n",
             depth_m.low, depth_m.median, depth_m.high, 100 * share);
  const auto shift = misregistration(probed.frames);
  if (shift) {
    fmt::print("alignment  colour edges {:+.1f} px right, {:+.1f} px below depth edges (contrast {:.2f})\n",
               shift->shift_px.x(), shift->shift_px.y(), shift->contrast);
  } else {
    fmt::print("alignment  unknown: depth edges agree with colour edges at no shift\n");
  }
  constexpr double kNearest_m = 0.3, kFarthest_m = 20;
  if (share == 0) return log::warn("no pixel has depth");
  if (depth_m.median >= kNearest_m && depth_m.median <= kFarthest_m) return;
  const auto scale = plausible_depth_scale(depth_m.median, probed.camera.depth_scale);
  log::warn("a median depth of {:.2g} m is hardly possible: {}", depth_m.median,
            scale && !probed.metric_depth
                ? fmt::format("with depth_scale: {} instead of {} it would be {:.1f} m", *scale,
                              probed.camera.depth_scale, depth_m.median * probed.camera.depth_scale / *scale)
                : "check the unit of depth");
}

void print_probed(const Probed& probed) {
  const RgbdCamera& camera = probed.camera;
  print_text(fmt::format("{}: {}\n", probed.name, probed.description));
  fmt::print("colour     {}\n", lens_text(camera.color));
  if (camera.depth) {
    fmt::print("           depth camera {}, {:.1f} mm from colour\n", lens_text(*camera.depth),
               1e3 * camera.T_color_depth.translation.norm());
  }
  fmt::print("sensor     {}\n", sensor_text(camera.sensor));
  print_pairs(probed);
  print_times(probed);
  print_depth(probed);
  fmt::print("truth      {} poses\n", probed.truth);
  fmt::print("decoded    {} frames, {} damaged or listed wrongly\n", probed.frames.size(),
             probed.skipped.size());
  if (!probed.skipped.empty()) log::warn("the first bad frame: {}", probed.skipped.front().reason);
  print_contradictions(probed);
}

/// The camera with which a run would map the recording; no image is decoded of a folder.
RgbdCamera camera_of(const SourceRequest& request) {
  if (source_kind(request.sequence) == SourceKind::kRecording) return open_frame_source(request)->camera();
  return read_folder(request).camera;
}

void probe(const ProbeArguments& arguments) {
  const SourceKind kind = source_kind(arguments.sequence);
  if (kind == SourceKind::kLive)
    throw UsageError("probe: a live camera cannot be probed; record it with kinloop record");
  SourceRequest request;
  request.sequence = arguments.sequence;
  request.chosen = arguments.chosen;
  set_camera(request, arguments.camera);
  if (arguments.print_camera) return print_text(camera_file_text(camera_of(request)));
  print_probed(kind == SourceKind::kRecording ? probe_source(request) : probe_layout(request));
}

}  // namespace

void add_probe_command(CLI::App& app) {
  auto arguments = std::make_shared<ProbeArguments>();
  CLI::App* command =
      app.add_subcommand("probe", "Say what a recording is: layout, camera, rates, depth, alignment");
  command->add_option("PATH", arguments->sequence, "a folder or file, as for kinloop run")->required();
  add_sequence_option(*command, arguments->chosen);
  add_camera_options(*command, arguments->camera);
  command->add_flag("--print-camera", arguments->print_camera,
                    "only print the camera of the recording, in the format of camera.yaml");
  command->footer(
      "Decodes 30 frames spread over the sequence. Alignment is the shift that best brings the borders of\n"
      "near objects in depth onto edges in colour; it is about 0 if depth is registered. The exit code is 3 "
      "if\n"
      "depth is mirrored or upside down.");
  command->callback([arguments] { probe(*arguments); });
}

}  // namespace kinloop
