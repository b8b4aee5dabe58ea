#include "session/plan/run_plan.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "kinloop/sensor/source/guessed_unit.hpp"
#include "session/input/input_traits.hpp"
#include "session/source/source_filters.hpp"

namespace kinloop {
namespace {

/// What the user says of the recording.
SourceRequest resolve_recording(const RunRequest& request) {
  SourceRequest recording = request.source;
  CameraOptions camera = request.camera;
  recording.guess_camera = camera.camera == "guess";
  if (recording.guess_camera) camera.camera.clear();
  set_camera(recording, camera);
  return recording;
}

void require_available(PoseGraphSolver solver) {
  if (pose_graph_solver_available(solver)) return;
  throw UsageError(fmt::format(
      "solver {}: not available in this build; use builtin or ceres, or omit --solver", name_of(solver)));
}

RunOptions options_of(const RunSettings& settings, const std::optional<ContinuedMap>& start, int threads) {
  RunOptions options = start ? start->options() : RunOptions();
  const FeatureKind features = options.slam.features.kind;
  options.slam.global_ba.threads = threads;
  options.slam.localize_only = settings.localize;
  if (settings.memory_mib > 0) options = with_memory_limit(options, settings.memory_mib);
  if (settings.budget_percent > 0) options = within_budget(options, settings.budget_percent);
  options = run_options_with(options, settings.assignments);
  if (start && options.slam.features.kind != features)
    throw UsageError(fmt::format("features.kind: must be {}, as in the loaded map", name_of(features)));
  if (settings.no_loop) options.slam.loop.enabled = false;
  if (!settings.solver.empty())
    options = run_options_with(options, std::vector{"loop.pose_graph.solver=" + settings.solver});
  require_available(options.slam.loop.pose_graph.solver);
  return options;
}

/// The frames of a run, and what they are.
struct OpenedSource {
  std::unique_ptr<FrameSource> frames;
  const PacedSource* paced = nullptr;  ///< part of `frames`, if they are paced
  InputTraits traits;
};

OpenedSource open_source(const SourceRequest& recording, double pace_hz) {
  // A sender may wait for the pose of each frame before it sends the next one.
  constexpr size_t kFirstFrames = 10;
  const size_t ahead = source_kind(recording.sequence) == SourceKind::kLive ? 0 : kFirstFrames;
  auto peeked = std::make_unique<PeekedSource>(open_frame_source(recording), ahead);
  const std::deque<Frame>& first_frames = peeked->first_frames();  // stays, whatever is put around it
  OpenedSource source{std::move(peeked), nullptr, {}};
  if (pace_hz > 0) {
    auto paced = std::make_unique<PacedSource>(std::move(source.frames), pace_hz);
    source.paced = paced.get();
    source.frames = std::move(paced);
  }
  source.traits = traits_of(*source.frames, first_frames);
  return source;
}

/// What the source itself, behind all that was put around it, says of its unit.
std::string depth_unit_guess_of(const FrameSource& outermost) {
  const FrameSource* source = &outermost;
  while (const auto* forwarding = dynamic_cast<const ForwardingSource*>(source))
    source = &forwarding->inner();
  const auto* guessed = dynamic_cast<const GuessedUnit*>(source);
  return guessed == nullptr ? std::string() : guessed->depth_unit_guess();
}

}  // namespace

RunSetup set_up_run(const RunSettings& settings) {
  RunSetup setup;
  setup.threads = settings.threads > 0 ? settings.threads : hardware_threads();
  setup.start = open_continued_map(settings.load_map);
  setup.options = options_of(settings, setup.start, setup.threads);
  return setup;
}

RunPlan plan_run(const RunRequest& request) {
  const RunSettings& settings = request.settings;
  SourceRequest recording = resolve_recording(request);
  RunSetup setup = set_up_run(settings);
  recording.simulation = setup.options.sim;
  recording.kinect = setup.options.kinect;
  recording.threads = setup.threads;
  OpenedSource source = open_source(recording, request.pace_hz);
  setup.options = suited_to(source.traits, std::move(setup.options), settings.assignments);
  RgbdCamera camera = source.frames->camera();
  if (setup.start) camera = setup.start->adapt(camera);
  auto memory = request.remember ? sensor_memory_of(source.frames->info()) : std::nullopt;
  if (memory) camera = memory->recall(camera);
  Vocabulary vocabulary = open_vocabulary(settings.vocabulary, setup.options.slam.features);
  std::string guess = depth_unit_guess_of(*source.frames);
  return {std::move(setup), std::move(source.frames), camera, std::move(memory), std::move(vocabulary),
          source.paced,     std::move(guess)};
}

Vocabulary open_vocabulary(const std::string& file, const FeatureOptions& features) {
  if (!file.empty()) {
    Vocabulary vocabulary = read_vocabulary(file);
    if (vocabulary.tree().kind == descriptor_kind(features, Metric::kHamming)) return vocabulary;
    throw UsageError(
        fmt::format("{}: a vocabulary of {}, but features.kind={} requires one of 256 bits; "
                    "train it with "
                    "`kinloop vocab train IMAGES... --feature {} -o FILE`",
                    file, vocabulary.descriptors().name, name_of(features.kind), name_of(features.kind)));
  }
  if (features.kind != FeatureKind::kOrb) {
    throw UsageError(
        fmt::format("features.kind={0}: the built-in vocabulary is for ORB; train one with `kinloop vocab "
                    "train IMAGES... "
                    "--feature {0} -o FILE` and pass --vocabulary FILE",
                    name_of(features.kind)));
  }
  return load_default_vocabulary();
}

}  // namespace kinloop
