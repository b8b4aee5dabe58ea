#include "apps/map/withdraw_from_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <regex>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/map/components_of.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "session/plan/run_plan.hpp"
#include "session/store/command_files.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {
namespace {

/// The landmarks that both keyframes observe: the points by the depth of `a`, the measurements of `b`.
std::vector<PoseObservation> shared_observations(const Keyframe& a, const Keyframe& b, const Map& map,
                                                 const PinholeCamera& camera) {
  std::vector<PoseObservation> observations;
  for (uint32_t in_a = 0; in_a < a.landmark_of.size(); ++in_a) {
    const auto depth_m = static_cast<double>(a.features->depths_m[in_a]);
    if (!a.landmark_of[in_a].valid() || !(depth_m > 0)) continue;
    for (const Observation& seen : map.landmark(a.landmark_of[in_a]).observations) {
      if (seen.keyframe != b.id) continue;
      observations.push_back({compensated_measurement(*b.features, seen.feature),
                              camera.unproject(a.features->pixels[in_a].cast<double>(), depth_m)});
    }
  }
  return observations;
}

/// The relative pose as two keyframes alone measure it; nullopt if they share too little.
std::optional<SE3> measured_pose(const PoseGraphEdge& edge, const Map& map, const Sensor& sensor,
                                 const AbsolutePoseOptions& options) {
  const Keyframe &a = map.keyframe(KeyframeId{edge.a}), &b = map.keyframe(KeyframeId{edge.b});
  const auto observations = shared_observations(a, b, map, sensor.camera);
  const auto solution = solve_absolute_pose(sensor, observations, edge.T_a_b, options);
  return solution ? std::optional(solution->T_reference_camera) : std::nullopt;
}

/// Solves the pose graph of all loops and of odometry that no loop has bent.
void solve_again(Map& map, const Sensor& sensor, const PlaceOptions& options) {
  PoseGraph graph = make_pose_graph(map, options.loop);
  for (PoseGraphEdge& edge : graph.edges)
    edge.T_a_b = measured_pose(edge, map, sensor, options.tracking.pose).value_or(edge.T_a_b);
  const std::vector<SE3> T_world_vertex = solve_pose_graph(graph, options.loop.pose_graph).T_world_vertex;
  MapUpdate update;
  update.newest_keyframe = map.keyframes().back().id;
  update.epoch = map.epoch();
  for (uint32_t i = 0; i < T_world_vertex.size(); ++i)
    update.T_world_camera.emplace_back(KeyframeId{i}, T_world_vertex[i]);
  map.apply(update);
}

/// The stamps of the keyframes of a loop, the earlier one first.
struct LoopStamps {
  int64_t earlier_ns = 0, later_ns = 0;

  bool operator==(const LoopStamps&) const = default;
};

LoopStamps stamps_of(const LoopClosure& loop, const MapData& map) {
  const auto [earlier_ns, later_ns] =
      std::minmax(map.keyframes[loop.a.value].stamp_ns, map.keyframes[loop.b.value].stamp_ns);
  return {earlier_ns, later_ns};
}

LoopStamps parse_stamps(const std::string& text) {
  const size_t comma = text.find(',');
  const auto a_ns = parse_stamp_ns(text.substr(0, comma));
  const auto b_ns = comma == std::string::npos ? std::nullopt : parse_stamp_ns(text.substr(comma + 1));
  if (!a_ns || !b_ns)
    throw UsageError(fmt::format("--loop {}: expected the stamps of two keyframes, as 12.3,45.6", text));
  return {std::min(*a_ns, *b_ns), std::max(*a_ns, *b_ns)};
}

/// Those loops whose ends are nearest in time, as arguments of --loop.
std::string nearest_to(const LoopStamps& wanted, const MapData& map) {
  constexpr size_t kListed = 3;
  std::vector<LoopStamps> all;
  for (const LoopClosure& loop : map.loop_closures) all.push_back(stamps_of(loop, map));
  const auto distance_s = [&](const LoopStamps& stamps) {
    return std::abs(to_seconds(stamps.earlier_ns) - to_seconds(wanted.earlier_ns)) +
           std::abs(to_seconds(stamps.later_ns) - to_seconds(wanted.later_ns));
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto& a, const auto& b) { return distance_s(a) < distance_s(b); });
  std::string text;
  for (size_t i = 0; i < std::min(kListed, all.size()); ++i) {
    text += fmt::format("{}{},{}", i > 0 ? " " : "", format_stamp(all[i].earlier_ns),
                        format_stamp(all[i].later_ns));
  }
  return text;
}

/// The loops with these stamps. Throws InputError naming the nearest ones if there are none.
std::vector<LoopEnds> find_loops(const WithdrawalRequest& request, const MapData& map) {
  const std::string file = request.map.string();
  if (map.loop_closures.empty()) throw InputError(fmt::format("{}: has no loops", file));
  std::set<LoopEnds> found;
  for (const std::string& text : request.loops) {
    const LoopStamps wanted = parse_stamps(text);
    const size_t before = found.size();
    bool named_before = false;
    for (const LoopClosure& loop : map.loop_closures) {
      if (stamps_of(loop, map) == wanted) named_before |= !found.insert(loop.ends()).second;
    }
    if (found.size() == before && !named_before) {
      throw InputError(
          fmt::format("{}: no loop joins {}; the nearest: {}", file, text, nearest_to(wanted, map)));
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace

void withdraw_loops(SavedMap& saved, std::span<const LoopEnds> loops, const Sensor& sensor,
                    const PlaceOptions& options) {
  Map map;
  map.append(std::move(saved.map));
  const std::vector<SE3> before = map.withdraw_loops(loops, LoopReason::kByUser);
  if (!before.empty()) saved.frames = rebased_after_split(std::move(saved.frames), map, before);
  solve_again(map, sensor, options);
  saved.map = map.data();
}

WithdrawalResult withdraw_from_file(const WithdrawalRequest& request, const Progress& progress) {
  require_outputs({.inputs = {request.map}, .outputs = {{"-o", request.output}}});
  const MapReader reader(request.map);
  SavedMap saved = read_map_with_warnings(reader, request.map);
  const std::vector<LoopEnds> loops = find_loops(request, saved.map);

  RunOptions options = restore_options(saved, request.map);
  options.slam.global_ba.threads = hardware_threads();
  options.slam.localize_only = false;
  const RgbdCamera camera = saved.camera;
  const Sensor sensor = sensor_estimate(saved.sensor, make_sensor(camera, options.slam.noise)).sensor;
  withdraw_loops(saved, loops, sensor, {options.slam.tracking, options.slam.local_map, options.slam.loop});
  Slam slam(camera, options.slam, open_vocabulary({}, options.slam.features));
  DenseRecorder recorder(camera, options.dense);
  load_images(reader, request.map, slam.add_map(std::move(saved)), recorder);
  slam.finish(progress);
  MapSaver(request.output, {slam, recorder, options, {}}, 0).save();
  const Map& map = slam.map();
  return {loops.size(), map.loop_closures().size(), map.keyframes().size(), components_of(map.keyframes())};
}

std::filesystem::path free_withdrawn_name(const std::filesystem::path& map) {
  const std::regex suffix_of_output("_withdrawn(_[0-9]+)?$");
  const std::string stem = std::regex_replace(map.stem().string(), suffix_of_output, "") + "_withdrawn";
  const auto named = [&](int number) {
    const std::string suffix = number > 1 ? fmt::format("_{}", number) : "";
    return map.parent_path() / fmt::format("{}{}{}", stem, suffix, map.extension().string());
  };
  int number = 1;
  while (std::filesystem::exists(named(number))) ++number;
  return named(number);
}

}  // namespace kinloop
