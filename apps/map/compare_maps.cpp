#include "apps/map/compare_maps.hpp"

#include <algorithm>
#include <span>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>

#include "apps/shared/terminal/interrupt.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "viewer/report/report.hpp"
#include "viewer/saved/saved_run.hpp"

namespace kinloop {
namespace {

/// Returns the views of the component that holds most images of both maps, split by the map they are of.
std::pair<std::vector<PosedImage>, std::vector<PosedImage>> views_of_both(const MergedMaps& merged) {
  std::pair<std::vector<PosedImage>, std::vector<PosedImage>> both;
  const Slam& slam = *merged.slam;
  const uint32_t component = main_component(slam.log(), slam.map());
  for (const PosedImage& view : merged.recorder->views(slam.log(), slam.map(), component)) {
    const bool is_of_a = merged.recorder->frame_of_image(view.image) < merged.first_of_b;
    (is_of_a ? both.first : both.second).push_back(view);
  }
  return both;
}

/// The frames of one map that were tracked in a component.
Trajectory path_in(uint32_t component, std::span<const LoggedFrame> log, const Map& map) {
  Trajectory path;
  for (const LoggedFrame& entry : log) {
    if (is_tracked_in(component, entry, map)) path.push_back({entry.stamp_ns, entry.world(map)});
  }
  return path;
}

/// The keyframes of a component, split by the map they are of, and the number of each among those of
/// `before`, followed by those of `after`.
std::unordered_map<KeyframeId, KeyframeId> split_keyframes(const Map& map, uint32_t component,
                                                           FrameId first_of_b, ComparedVisit& before,
                                                           ComparedVisit& after) {
  std::unordered_map<KeyframeId, KeyframeId> number_of;
  for (const Keyframe& keyframe : map.keyframes()) {  // those of `before` come first
    if (keyframe.component != component) continue;
    number_of.emplace(keyframe.id, KeyframeId{static_cast<uint32_t>(number_of.size())});
    (keyframe.frame < first_of_b ? before : after)
        .keyframes.push_back({keyframe.stamp_ns, keyframe.T_world_camera});
  }
  return number_of;
}

/// The frames of one map, with its poses in the joined one, and their errors where the folder has the truth.
std::vector<TimelineFrame> timeline_in(const std::filesystem::path& input, const ComparedVisit& visit,
                                       std::span<const LoggedFrame> log) {
  SavedRun run = read_frames_and_truth(input);
  if (run.frames.empty()) run.doubt_ns = doubt_of(log);
  run.path = visit.path;
  run.keyframes = visit.keyframes;
  const auto ate = absolute_trajectory_error(run.path, run.truth);
  return timeline_of(run, ate ? ate->poses : std::vector<PoseError>());
}

}  // namespace

ComparedMaps compare_maps(const MergeRequest& request, const Progress& progress) {
  ComparedMaps compared;
  compared.merged = merge_maps(request, progress);
  const MergedMaps& merged = compared.merged;
  throw_if_interrupted();
  if (merged.loops_between == 0) {
    throw InputError(fmt::format(
        "{}: no place of {} was recognised in it, so they cannot be compared; record the same place again, "
        "with some views like those of the other recording",
        request.b.string(), request.a.string()));
  }
  std::tie(compared.views_a, compared.views_b) = views_of_both(merged);
  require_images(compared.views_a.size(), request.a);
  require_images(compared.views_b.size(), request.b);
  DenseRecorder& recorder = *merged.recorder;
  const DenseOptions& dense = merged.options.dense;
  const ComparisonOptions options{dense_camera(merged.camera, merged.slam->sensor_estimate()), dense.limits,
                                  dense.voxel_m, hardware_threads()};
  compared.before = recorder.fuse_views(compared.views_a, options.camera, options.threads, progress);
  compared.after = recorder.fuse_views(compared.views_b, options.camera, options.threads, progress);
  compared.difference =
      compare_visits_of_place({compared.before, {recorder.images(), compared.views_a}},
                              {compared.after, {recorder.images(), compared.views_b}}, options, progress);
  throw_if_interrupted();
  compared.up = recorder.up(compared.views_a, options.camera);
  return compared;
}

Comparison comparison_of(const ComparedMaps& compared, const MergeRequest& request) {
  const MergedMaps& merged = compared.merged;
  const Map& map = merged.slam->map();
  const std::span log(merged.slam->log());
  const auto frames_of_a = static_cast<size_t>(
      std::ranges::lower_bound(log, merged.first_of_b, {}, &LoggedFrame::id) - log.begin());
  const uint32_t component = main_component(log, map);
  const PinholeCamera& camera = merged.camera.color;
  Comparison shown{.before = {input_name(request.a.string()),
                              path_in(component, log.first(frames_of_a), map),
                              {},
                              compared.before,
                              {}},
                   .after = {input_name(request.b.string()),
                             path_in(component, log.subspan(frames_of_a), map),
                             {},
                             compared.after,
                             {}},
                   .difference = compared.difference,
                   .loops = {},
                   .loops_between = merged.loops_between,
                   .up = compared.up.direction,
                   .R_file_world = compared.file_frame().R_file_world,
                   .half_size_at_1m = {camera.width / camera.fx / 2, camera.height / camera.fy / 2}};
  const auto number_of = split_keyframes(map, component, merged.first_of_b, shown.before, shown.after);
  shown.before.timeline = timeline_in(request.a, shown.before, log.first(frames_of_a));
  shown.after.timeline = timeline_in(request.b, shown.after, log.subspan(frames_of_a));
  for (const LoopClosure& loop : map.loop_closures()) {
    const auto a = number_of.find(loop.a), b = number_of.find(loop.b);
    if (a != number_of.end() && b != number_of.end()) shown.loops.emplace_back(a->second, b->second);
  }
  return shown;
}

}  // namespace kinloop
