#include "apps/run/summary/run_summary.hpp"

#include <algorithm>
#include <filesystem>
#include <span>

#include <fmt/format.h>
#include <sys/resource.h>

#include "apps/shared/command_line/version.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/text/rounded_number.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/map/frames/pose_covariance.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "session/run_quality.hpp"
#include "tools/evaluation/consistency.hpp"
#include "viewer/report/report.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// The input as given; `.` and `..`, which name nothing in other folders, as an absolute path.
std::string lasting_input_name(const std::string& input) {
  const std::string name = input_name(input);
  if (name != "." && name != "..") return input;
  return std::filesystem::weakly_canonical(input).string();
}

json options_json(RunOptions options) {
  json values = json::object();
  for (const OptionEntry& entry : option_entries(options)) {
    std::visit([&](const auto& value) { values[entry.key] = value; }, entry.value);
  }
  return values;
}

json sensor_json(const SensorEstimate& estimate) {
  json parameters = json::object();
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (!estimate.used[static_cast<size_t>(k)]) continue;
    parameters[sensor_parameter_name(static_cast<SensorParameter>(k))] = {
        {"value", estimate.sensor.corrections(k)}, {"sigma", estimate.sigma(k)}};
  }
  return parameters;
}

/// The keyframes of a component, with their covariances.
std::vector<PoseWithCovariance> poses_with_covariance(const Slam& slam, uint32_t component) {
  const auto& covariance = slam.keyframe_covariance();
  std::vector<PoseWithCovariance> poses;
  for (const Keyframe& keyframe : slam.map().keyframes()) {
    if (keyframe.component != component || keyframe.id.value >= covariance.size()) continue;
    poses.push_back({keyframe.stamp_ns, keyframe.T_world_camera, covariance[keyframe.id.value]});
  }
  return poses;
}

/// The first keyframe of a component, the reference, and the frames between the keyframes.
std::vector<PoseWithCovariance> frames_with_covariance(const Slam& slam, uint32_t component) {
  const auto keyframes = poses_with_covariance(slam, component);
  if (keyframes.empty()) return {};
  std::vector<PoseWithCovariance> poses = {keyframes.front()};
  for (const LoggedFrame& frame : slam.session_log()) {
    if (!is_tracked_in(component, frame, slam.map()) || frame.keyframe.valid() || frame.is_doubtful())
      continue;
    poses.push_back({frame.stamp_ns, frame.world(slam.map()), frame.world_covariance});
  }
  return poses;
}

/// Covariances of (translation; rotation) in camera axes, m and rad, the upper triangles row by row.
json covariances_json(const std::vector<PoseWithCovariance>& poses) {
  json all = json::array();
  for (const PoseWithCovariance& pose : poses) {
    all.push_back({{"stamp", format_stamp(pose.stamp_ns)}, {"covariance", upper_triangle(pose.covariance)}});
  }
  return all;
}

json consistency_json(const std::vector<PoseWithCovariance>& poses, const Trajectory& truth) {
  const auto found = evaluate_consistency(poses, truth);
  if (!found) return nullptr;
  return {{"poses", found->poses},
          {"nees_translation", found->nees_translation},
          {"nees_rotation", found->nees_rotation},
          {"within_4_sigma", found->within_4_sigma},
          {"expected", 3}};
}

json latency_json(const std::vector<double>& times_ms) {
  return {{"median", quantile(times_ms, 0.5)},
          {"p99", quantile(times_ms, 0.99)},
          {"longest", quantile(times_ms, 1.0)}};
}

json skipped_json(const FrameSource& source) {
  json skipped = json::array();
  for (const auto& [name, reason] : source.skipped()) skipped.push_back({{"name", name}, {"reason", reason}});
  return skipped;
}

json quality_json(const RunQuality& quality) {
  return {{"verdict", name_of(quality.verdict)},
          {"seconds", quality.seconds},
          {"seconds_doubtful", quality.seconds_doubtful},
          {"seconds_lost", quality.seconds_lost},
          {"reasons", quality.reasons}};
}

json warnings_json(const std::vector<InputWarning>& warnings) {
  json all = json::array();
  for (const InputWarning& warning : warnings) {
    all.push_back(
        {{"kind", name_of(warning.fault)}, {"evidence", warning.evidence}, {"remedy", warning.remedy}});
  }
  return all;
}

/// The hints that were given: how long, and what to do.
json advice_json(const RecordingAdvisor& advisor) {
  json all = json::array();
  for (size_t i = 0; i < kRecordingHints; ++i) {
    const auto hint = static_cast<RecordingHint>(i);
    if (advisor.seconds(hint) <= 0) continue;
    all.push_back({{"kind", name_of(hint)},
                   {"seconds", rounded_number(advisor.seconds(hint))},
                   {"advice", text_of(hint)}});
  }
  return all;
}

json timings_json(const Timings& times) {
  json timings = json::object();
  for (const auto& [module, elapsed] : times.modules) {
    timings[module] = {{"wall_s", elapsed.wall_s},
                       {"cpu_s", elapsed.cpu_s},
                       {"median_ms", quantile(elapsed.samples_ms, 0.5)},
                       {"p95_ms", quantile(elapsed.samples_ms, 0.95)},
                       {"cpu_p95_ms", quantile(elapsed.cpu_samples_ms, 0.95)}};
  }
  return timings;
}

void add_latencies(json& summary, const RunOutcome& o) {
  if (!o.latencies_ms.empty()) summary["latency_ms"] = latency_json(o.latencies_ms);
  // Some cameras stamp images by another clock than the time of day.
  constexpr double kMaxAge_ms = 60e3;
  const auto [least, most] = std::minmax_element(o.ages_ms.begin(), o.ages_ms.end());
  if (o.plan.source->info().live && !o.ages_ms.empty() && *least > 0 && *most < kMaxAge_ms)
    summary["latency_from_stamp_ms"] = latency_json(o.ages_ms);
}

/// Frames of the trajectory without a measurement of their own.
long count_predicted(std::span<const LoggedFrame> log, uint32_t component, const Map& map) {
  return std::count_if(log.begin(), log.end(), [&](const LoggedFrame& frame) {
    return is_tracked_in(component, frame, map) && !frame.is_doubtful() &&
           frame.method == TrackingMethod::kPredicted;
  });
}

}  // namespace

void add_timings(json& summary, const Timings& slam, const Timings& program) {
  summary["timings"] = timings_json(slam);
  summary["timings"].update(timings_json(program));
  summary["cpu_s"] = process_cpu_s();
}

json run_summary(const RunOutcome& o) {
  const FrameSource& source = *o.plan.source;
  const auto log = o.slam.session_log();
  const uint32_t component = o.slam.component();
  const auto located = std::count_if(
      log.begin(), log.end(), [&](const auto& f) { return is_tracked_in(component, f, o.slam.map()); });
  const long doubtful = count_doubtful_poses(log, o.slam.map());
  const auto not_lost = std::count_if(log.begin(), log.end(), [](const auto& f) { return !f.is_lost(); });
  const auto dense_only = std::count_if(log.begin(), log.end(), [](const auto& f) {
    return !f.is_lost() && f.method == TrackingMethod::kDense;
  });
  json summary = json::object();  // [] on null crashes when memory runs out
  summary["version"] = version_text();
  summary["input"] = lasting_input_name(source.info().name);
  summary["frames"] = log.size();
  summary["quality"] =
      quality_json(with_guessed_unit(judge(judged_frames(log, o.slam.map())), o.plan.depth_unit_guess));
  summary["warnings"] = warnings_json(o.warnings);
  summary["advice"] = advice_json(o.advisor);
  summary["tracked"] = located - doubtful;
  summary["doubtful"] = doubtful;
  summary["predicted"] = count_predicted(log, component, o.slam.map());  // of those tracked
  summary["tracked_densely"] = dense_only;
  summary["tracked_in_other_components"] = not_lost - located;  // in components not joined by any loop
  summary["skipped"] = skipped_json(source);                    // the first ones
  summary["skipped_total"] = source.skipped().size();
  summary["dropped"] = o.plan.dropped();
  summary["interrupted"] = o.interrupted;
  summary["keyframes"] = o.slam.map().keyframes().size();
  summary["landmarks"] = o.slam.map().landmark_count();
  summary["loops"] = loops_json(o.slam.map().loop_closures(), o.slam.map());
  summary["other_loops"] = loops_json(o.slam.map().other_loops(), o.slam.map());  // no edges of the map
  summary["sensor"] = sensor_json(o.slam.sensor_estimate());
  summary["depth_sensor"] = name_of(source.camera().sensor.model);
  const auto noise_scale = depth_noise_scale(o.slam);
  summary["depth_noise_scale"] = noise_scale ? json(*noise_scale) : json(nullptr);
  summary["wall_s"] = o.wall_s;
  summary["threads"] = o.plan.threads;
  summary["frame_ms"] = {{"median", quantile(o.slam.timings().frame_ms, 0.5)},
                         {"p95", quantile(o.slam.timings().frame_ms, 0.95)}};
  add_latencies(summary, o);
  summary["peak_memory_mib"] = peak_memory_mib();
  if (o.map_points) summary["map"] = {{"points", *o.map_points}, {"voxel_m", o.plan.options.dense.voxel_m}};
  const auto poses = poses_with_covariance(o.slam, component);
  summary["keyframe_covariances"] = covariances_json(poses);
  if (o.evaluation) {
    summary["evaluation"] = to_json(*o.evaluation);
    const Trajectory& truth = source.info().ground_truth;
    json consistency = consistency_json(poses, truth);
    if (!consistency.is_null()) {
      consistency["frames"] = consistency_json(frames_with_covariance(o.slam, component), truth);
      consistency["online"] = consistency_json(o.live_poses, truth);
    }
    summary["evaluation"]["consistency"] = consistency;
    const auto live = evaluate(trajectory_of(o.live_poses), truth);
    summary["evaluation"]["live"] = live ? to_json(*live) : json(nullptr);
  }
  summary["options"] = options_json(o.plan.options);
  return summary;
}

std::string profile_text(const json& s) {
  std::vector<std::pair<double, std::string>> modules;  // CPU seconds and name
  for (const auto& [name, module] : s["timings"].items()) modules.emplace_back(module["cpu_s"], name);
  std::sort(modules.rbegin(), modules.rend());
  const double total_s = s["cpu_s"], frames = std::max(1.0, s["frames"].get<double>());
  std::string text = fmt::format("{:<26} {:>8} {:>6} {:>9} {:>10} {:>10} {:>8}\n", "module", "CPU s", "%",
                                 "ms/frame", "median ms", "95 % ms", "wall s");
  double sum_s = 0;
  for (const auto& [cpu_s, name] : modules) {
    const json& module = s["timings"][name];
    sum_s += cpu_s;
    text += fmt::format("{:<26} {:>8.2f} {:>6.1f} {:>9.2f} {:>10.2f} {:>10.2f} {:>8.2f}\n", name, cpu_s,
                        100 * cpu_s / total_s, 1e3 * cpu_s / frames, module["median_ms"].get<double>(),
                        module["p95_ms"].get<double>(), module["wall_s"].get<double>());
  }
  return text + fmt::format("{:<26} {:>8.2f} {:>6.1f} {:>9.2f}   of {:.2f} CPU s of the process\n", "sum",
                            sum_s, 100 * sum_s / total_s, 1e3 * sum_s / frames, total_s);
}

std::string quality_text(const json& s) {
  std::string text = "quality: " + s["quality"]["verdict"].get<std::string>();
  std::string separator = ": ";
  for (const json& reason : s["quality"]["reasons"]) {
    text += separator + reason.get<std::string>();
    separator = "; ";
  }
  return text;
}

std::string summary_text(const json& s) {
  std::string map;
  if (s.contains("map")) {
    map = fmt::format("map        {} points, voxels of {} m\n", s["map"]["points"].get<long>(),
                      s["map"]["voxel_m"].get<double>());
  }
  if (s["depth_noise_scale"].is_number()) {
    map += fmt::format("depth      noise {:.2f} times that expected of {}\n",
                       s["depth_noise_scale"].get<double>(), s["depth_sensor"].get<std::string>());
  }
  std::string text = fmt::format(
      "frames     {} tracked of {} ({} of them predicted, {} doubtful, {} in other map components, {} "
      "damaged, {} dropped)\n"
      "keyframes  {}, landmarks {}, loops {}\n"
      "{}"
      "time       {:.1f} s, {:.1f} ms per frame (median), {:.1f} ms (95th percentile)\n"
      "memory     {:.0f} MiB peak\n",
      s["tracked"].get<long>(), s["frames"].get<long>(), s["predicted"].get<long>(),
      s["doubtful"].get<long>(), s["tracked_in_other_components"].get<long>(),
      s["skipped_total"].get<size_t>(), s["dropped"].get<long>(), s["keyframes"].get<long>(),
      s["landmarks"].get<long>(), s["loops"].size(), map, s["wall_s"].get<double>(),
      s["frame_ms"]["median"].get<double>(), s["frame_ms"]["p95"].get<double>(),
      s["peak_memory_mib"].get<double>());
  if (!s.contains("evaluation")) return text;
  const json& e = s["evaluation"];
  text += fmt::format("error      ATE {:.4f} m", e["ate"]["rmse_m"].get<double>());
  if (e["live"].is_object()) text += fmt::format(", {:.4f} m live", e["live"]["ate"]["rmse_m"].get<double>());
  return text + "\n";
}

}  // namespace kinloop
