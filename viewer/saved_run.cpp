#include "viewer/saved_run.hpp"

#include <algorithm>

#include "kinloop/base/time.hpp"
#include "kinloop/eval/evaluate.hpp"
#include "kinloop/eval/run_up.hpp"
#include "kinloop/output/ply.hpp"
#include "kinloop/output/run_folder.hpp"
#include "viewer/scene/growing_cloud.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Points in one piece of the cloud: what a browser takes in at one go.
constexpr size_t kPiecePoints = 1 << 16;

Trajectory read_if_there(const fs::path& path) {
  return fs::exists(path) ? read_tum_trajectory(path) : Trajectory();
}

KeyframeId keyframe_at(const Trajectory& keyframes, const json& loop, const char* key) {
  if (!loop.contains(key) || !loop[key].is_string()) return {};
  const auto stamp_ns = parse_stamp_ns(loop[key].get<std::string>());
  const auto found = std::find_if(keyframes.begin(), keyframes.end(),
                                  [&](const StampedPose& pose) { return pose.stamp_ns == stamp_ns; });
  return found == keyframes.end() ? KeyframeId{}
                                  : KeyframeId{static_cast<uint32_t>(found - keyframes.begin())};
}

std::vector<std::pair<KeyframeId, KeyframeId>> loops_of(const json& figures, const Trajectory& keyframes) {
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;
  if (!figures.contains("loops") || !figures["loops"].is_array()) return loops;
  for (const json& loop : figures["loops"]) {
    const KeyframeId a = keyframe_at(keyframes, loop, "stamp_a"), b = keyframe_at(keyframes, loop, "stamp_b");
    if (a.valid() && b.valid()) loops.emplace_back(a, b);
  }
  return loops;
}

/// Thinned pieces would show stripes if each held a stretch of the file; so all points are mixed first.
void show_cloud(Scene& scene, const ColoredCloud& cloud) {
  const ColoredCloud mixed = shuffled(cloud);
  for (size_t first = 0; first < mixed.size(); first += kPiecePoints) {
    const auto begin = static_cast<long>(first);
    const auto end = static_cast<long>(std::min(mixed.size(), first + kPiecePoints));
    const CloudPiece piece{{},
                           {{mixed.points.begin() + begin, mixed.points.begin() + end},
                            {mixed.colors.begin() + begin, mixed.colors.begin() + end}}};
    scene.put(PartKind::kCloud, static_cast<uint32_t>(first / kPiecePoints), encode_cloud(piece));
  }
}

void show_paths(Scene& scene, const SavedRun& run) {
  const std::vector<SE3> keyframes = poses_of(run.keyframes);
  put_parts(scene, PartKind::kKeyframes, 0, keyframes.size(), [&](size_t begin, size_t end) {
    return encode_poses(std::span(keyframes).subspan(begin, end - begin));
  });
  std::vector<PathPoint> path;
  for (const StampedPose& pose : run.path) {
    path.push_back({{}, pose.T_world_camera.translation.cast<float>()});
  }
  put_parts(scene, PartKind::kPath, 0, path.size(), [&](size_t begin, size_t end) {
    return encode_path(std::span(path).subspan(begin, end - begin));
  });
  scene.put(PartKind::kLoops, 0, encode_pairs(run.loops));
}

std::optional<AteResult> show_truth(Scene& scene, const SavedRun& run) {
  auto ate = absolute_trajectory_error(run.path, run.truth);
  if (!ate) return ate;
  std::vector<Eigen::Vector3f> truth;
  for (const StampedPose& pose : run.truth) truth.emplace_back(pose.T_world_camera.translation.cast<float>());
  const SE3 T_world_truth = ate->T_truth_estimate.inverse();
  scene.put(PartKind::kTruth, 0, encode_points(truth));
  scene.put(PartKind::kTruthPose, 0, encode_poses({&T_world_truth, 1}));
  return ate;
}

}  // namespace

SavedRun read_saved_run(const fs::path& path) {
  SavedRun run;
  run.name = path.string();
  if (!fs::is_directory(path)) {
    run.cloud = read_ply(path);
    const FileFrame frame = read_ply_frame(path);
    if (frame.z_up) run.up = frame.R_file_world.conjugate() * Eigen::Vector3d::UnitZ();
    return run;
  }
  const auto folder = RunFolder::of_earlier_run(path);
  run.path = read_tum_trajectory(folder.trajectory());
  run.keyframes = read_if_there(folder.keyframes());
  run.truth = read_if_there(folder.ground_truth());
  if (fs::exists(folder.map())) run.cloud = read_ply(folder.map());
  if (fs::exists(folder.figures())) run.figures = read_figures(folder.figures());
  run.loops = loops_of(run.figures, run.keyframes);
  run.up = up_of_run(run.figures, run.path);
  return run;
}

void show_saved_run(Scene& scene, const SavedRun& run) {
  scene.put(
      PartKind::kHello, 0,
      encode_json({{"run", scene.run()}, {"input", run.name}, {"live", false}, {"frustum", {0.6, 0.45}}}));
  show_paths(scene, run);
  const auto ate = show_truth(scene, run);
  json status = {{"stage", "saved"},
                 {"frame", run.path.size()},
                 {"keyframes", run.keyframes.size()},
                 {"loops", run.loops.size()},
                 {"points", run.cloud.size()},
                 {"up", {run.up.x(), run.up.y(), run.up.z()}}};
  if (run.figures.contains("landmarks")) status["landmarks"] = run.figures["landmarks"];
  if (ate) status["ateM"] = ate->error_m.rmse;
  scene.put(PartKind::kStatus, 0, encode_json(status));
  show_cloud(scene, run.cloud);
}

}  // namespace kinloop
