#include "session/plan/run_plan.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "session/input/guess_camera.hpp"
#include "session/input/near_range.hpp"
#include "session/plan/work_budget.hpp"
#include "session/source/open_frame_source.hpp"
#include "session/source/source_filters.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {
namespace {

std::optional<ContinuedMap> open_continued_map(const std::filesystem::path& file_or_folder) {
  if (file_or_folder.empty()) return std::nullopt;
  const auto path = map_file_of(file_or_folder);
  MapReader reader(path);
  SavedMap saved = read_map_with_warnings(reader, path);
  return ContinuedMap{path, std::move(reader), std::move(saved)};
}

void require_available(PoseGraphSolver solver) {
  if (pose_graph_solver_available(solver)) return;
  throw UsageError(fmt::format(
      "solver {}: not available in this build; use builtin or ceres, or omit --solver", name_of(solver)));
}

RunOptions within_budget(const RunOptions& options, double percent) {
  const WorkLevel& level = work_level(percent);
  if (level.percent > percent)
    log::warn("--budget {}: the least work takes about {} % of a core at 30 Hz", percent, level.percent);
  return run_options_with(options, level.assignments);
}

RunOptions options_of(const RunSettings& settings, const std::optional<ContinuedMap>& start, int threads) {
  RunOptions options;
  if (start) options = restore_options(start->saved, start->path, "features.");
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

SourceRequest source_request(const RunRequest& request, const RunSetup& setup) {
  SourceRequest source;
  source.sequence = request.sequence;
  CameraOptions camera = request.camera;
  const bool is_guess = camera.camera == "guess";
  if (is_guess) camera.camera.clear();
  set_camera(source, camera);
  if (is_guess) {
    if (is_camera_or_stream(request.sequence) || is_recording(request.sequence))
      throw UsageError(
          "--camera guess: for folders of images; give the camera of other sources with --camera FILE");
    source.camera = guess_camera_aloud(request.sequence, source.depth_scale);
  }
  if (!request.topics.empty()) source.topics = request.topics;
  source.depth_offset_s = request.depth_offset_s;
  source.every = request.every;
  source.simulation = setup.options.sim;
  source.kinect = setup.options.kinect;
  source.threads = setup.threads;
  source.stop = request.stop;
  return source;
}

/// Options for the frames of `source`: of live ones, results are applied when ready, unless the user chose
/// otherwise.
RunOptions options_for(const FrameSource& source, RunOptions options, const RunSettings& settings) {
  if (source.info().live && !assigns(settings.assignments, "executor.mode"))
    options.slam.executor.mode = ExecutorMode::kLive;
  return with_sensor_range(std::move(options), source.camera().sensor, settings.assignments);
}

/// Options with a smaller minimum than usual where most depth of `first_frames` is nearer, unless the user
/// chose one or named the sensor.
RunOptions with_near_minimum(RunOptions options, const FrameSource& source,
                             const std::deque<Frame>& first_frames, const RunSettings& settings) {
  const RgbdCamera& camera = source.camera();
  if (camera.sensor.origin == SensorOrigin::kCameraFile || assigns(settings.assignments, "dense.min_depth_m"))
    return options;
  const double usual_m = options.dense.limits.min_depth_m;
  const auto near_m = near_minimum_m(first_frames, options.dense.limits, camera.depth_scale);
  if (!near_m) return options;
  log::info("{}: most depth is nearer than {} m: mapped from {:.2f} m on (else --set dense.min_depth_m={})",
            source.info().name, usual_m, *near_m, usual_m);
  return with_minimum_depth(std::move(options), *near_m);
}

}  // namespace

RgbdCamera ContinuedMap::adapt(RgbdCamera camera) const {
  require_same_camera(saved, path, camera);
  camera.depth_scale = saved.camera.depth_scale;
  return camera;
}

void ContinuedMap::restore_images(uint32_t shift, DenseRecorder& recorder) const {
  load_images(reader, path, shift, recorder);
}

RunSetup set_up_run(const RunSettings& settings) {
  RunSetup setup;
  setup.threads = settings.threads > 0 ? settings.threads : hardware_threads();
  setup.start = open_continued_map(settings.load_map);
  setup.options = options_of(settings, setup.start, setup.threads);
  return setup;
}

RunPlan plan_run(const RunRequest& request) {
  RunSetup setup = set_up_run(request.settings);
  auto source = open_frame_source(source_request(request, setup));
  if (!request.mask.empty()) {
    const PinholeCamera& color = source->camera().color;
    cv::Mat mask = read_mask(request.mask, {color.width, color.height});
    source = std::make_unique<MaskedSource>(std::move(source), std::move(mask));
  }
  // A sender may wait for the pose of each frame before it sends the next one.
  constexpr size_t kFirstFrames = 10;
  const size_t ahead = is_camera_or_stream(request.sequence) ? 0 : kFirstFrames;
  auto peeked = std::make_unique<PeekedSource>(std::move(source), ahead);
  const std::deque<Frame>& first_frames = peeked->first_frames();  // stays, whatever is put around it
  source = std::move(peeked);
  const PacedSource* paced = nullptr;
  if (request.pace_hz > 0) {
    auto owner = std::make_unique<PacedSource>(std::move(source), request.pace_hz);
    paced = owner.get();
    source = std::move(owner);
  }
  setup.options = options_for(*source, std::move(setup.options), request.settings);
  setup.options = with_near_minimum(std::move(setup.options), *source, first_frames, request.settings);
  RgbdCamera camera = setup.start ? setup.start->adapt(source->camera()) : source->camera();
  auto memory = request.remember ? sensor_memory_of(source->info()) : std::nullopt;
  if (memory) camera = memory->recall(camera);
  Vocabulary vocabulary = open_vocabulary(request.settings.vocabulary, setup.options.slam.features);
  return {std::move(setup), std::move(source), camera, std::move(memory), std::move(vocabulary), paced};
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
