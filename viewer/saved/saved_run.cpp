#include "viewer/saved/saved_run.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "dense/files/file_frame.hpp"
#include "dense/files/ply.hpp"
#include "dense/up_direction.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/lower_case.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/io/run_folder.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "viewer/index_by_stamp.hpp"
#include "viewer/point_files/point_file.hpp"
#include "viewer/report/frame_table.hpp"
#include "viewer/report/report.hpp"
#include "viewer/report/run_up_direction.hpp"
#include "viewer/saved/sent_shapes.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Trajectory read_if_there(const fs::path& path) {
  return fs::exists(path) ? read_tum_trajectory(path) : Trajectory();
}

FrameStatus frame_status(const std::string& status) {
  if (status == "lost") return FrameStatus::kLost;
  return status == "doubtful" ? FrameStatus::kDoubtful : FrameStatus::kTracked;
}

/// The frames of the path, for a run without a frame table.
FrameTable frames_of_path(const SavedRun& run) {
  FrameTable frames;
  for (const StampedPose& pose : run.path) {
    const bool doubtful = std::binary_search(run.doubt_ns.begin(), run.doubt_ns.end(), pose.stamp_ns);
    frames.push_back({.stamp_ns = pose.stamp_ns, .status = doubtful ? "doubtful" : "tracked"});
  }
  return frames;
}

std::vector<int64_t> doubt_of(const FrameTable& frames) {
  std::vector<int64_t> doubt_ns;
  for (const FrameRow& row : frames) {
    if (row.status == "doubtful" || row.status == "lost") doubt_ns.push_back(row.stamp_ns);
  }
  return doubt_ns;
}

/// The poses of the path that are in doubt themselves or come after frames that are, which the path may lack.
std::vector<FrameRange> doubt_in_path(const SavedRun& run) {
  auto next = run.doubt_ns.begin();
  return ranges_where(run.path.size(), [&](size_t i) {
    const auto first = next;
    while (next != run.doubt_ns.end() && *next <= run.path[i].stamp_ns) ++next;
    return next != first;
  });
}

void show_paths(Scene& scene, const SavedRun& run) {
  const std::vector<SE3> keyframes = camera_poses(run.keyframes);
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
  if (const auto doubt = doubt_in_path(run); !doubt.empty())
    scene.put(PartKind::kDoubt, 0, encode_ranges(doubt));
  scene.put(PartKind::kLoops, 0, encode_pairs(accepted_pairs(run.loops)));
}

/// Estimated and true positions, in turn, of the keyframes that have a true one; without keyframes, of some
/// frames.
std::vector<Eigen::Vector3f> truth_errors(const SavedRun& run, const SE3& T_world_truth) {
  constexpr size_t kMostFrames = 500;
  const Trajectory& estimates = run.keyframes.empty() ? run.path : run.keyframes;
  const size_t every = run.keyframes.empty() ? (estimates.size() + kMostFrames - 1) / kMostFrames : 1;
  std::vector<Eigen::Vector3f> ends;
  for (size_t i = 0; i < estimates.size(); i += std::max<size_t>(1, every)) {
    const auto T_truth = pose_at(run.truth, estimates[i].stamp_ns, 2 * kMaxAssociationNs);
    if (!T_truth) continue;
    const Eigen::Vector3d true_m = T_world_truth * T_truth->translation;
    ends.emplace_back(estimates[i].T_world_camera.translation.cast<float>());
    ends.emplace_back(true_m.cast<float>());
  }
  return ends;
}

std::optional<AteResult> show_truth(Scene& scene, const SavedRun& run) {
  auto ate = absolute_trajectory_error(run.path, run.truth);
  if (!ate) return ate;
  std::vector<Eigen::Vector3f> truth;
  for (const StampedPose& pose : run.truth) truth.emplace_back(pose.T_world_camera.translation.cast<float>());
  const SE3 T_world_truth = ate->T_truth_estimate.inverse();
  scene.put(PartKind::kTruth, 0, encode_points(truth));
  scene.put(PartKind::kTruthPose, 0, encode_poses({&T_world_truth, 1}));
  scene.put(PartKind::kTruthErrors, 0, encode_points(truth_errors(run, T_world_truth)));
  return ate;
}

/// Kinloop's own files state their frame; in those of most other programs z is up.
void read_up_direction_comment(const std::vector<std::string>& comments, SavedRun& run) {
  const auto says = [&](const char* text) {
    return std::any_of(comments.begin(), comments.end(),
                       [&](const std::string& comment) { return comment.starts_with(text); });
  };
  const bool z_up = says("frame z-up");
  run.up_known = z_up || says("kinloop") || says("frame camera");
  if (z_up || !run.up_known) run.up = Eigen::Vector3d::UnitZ();
}

SavedRun of_points(PointFile file, const fs::path& path) {
  SavedRun run;
  read_up_direction_comment(file.comments, run);
  ColoredMesh& mesh = file.mesh;
  if (mesh.points.empty()) throw InputError(fmt::format("{}: holds no points", path.string()));
  if (!mesh.triangles.empty()) {
    run.mesh = std::move(mesh);
    return run;
  }
  constexpr Rgb kGrey = {200, 200, 200};
  run.colored = !mesh.colors.empty();
  if (!run.colored) mesh.colors.assign(mesh.points.size(), kGrey);
  run.cloud.points = std::move(mesh.points);
  run.cloud.colors = std::move(mesh.colors);
  return run;
}

SavedRun read_single_file(const fs::path& path) {
  const std::string form = lower_case(path.extension().string());
  if (form == ".ply") return of_points(read_any_ply(path), path);
  if (form == ".pcd") return of_points(read_any_pcd(path), path);
  if (form == ".glb") {
    SavedRun run;
    run.model = read_glb(path);
    return run;
  }
  if (!fs::exists(path)) throw InputError(fmt::format("{}: no such file or folder", path.string()));
  throw InputError(fmt::format(
      "{}: cannot be shown; give the folder of a run, or a .kinmap, .ply, .pcd or .glb file", path.string()));
}

/// A mesh that `kinloop mesh` wrote into the folder.
void read_mesh(const fs::path& folder, SavedRun& run) {
  if (const fs::path glb = folder / "mesh.glb"; fs::exists(glb)) {
    run.model = read_glb(glb);
    return;
  }
  const fs::path ply = folder / "mesh.ply";
  if (!fs::exists(ply)) return;
  PointFile file = read_any_ply(ply);
  const FileFrame frame = parse_frame_comments(file.comments);
  const auto R_world_file = frame.T_file_world().inverse().rotation.cast<float>();
  for (Eigen::Vector3f& point : file.mesh.points) point = R_world_file * point;
  run.mesh = std::move(file.mesh);
}

SavedRun read_folder(const fs::path& path) {
  const auto folder = RunFolder::open_existing(path);
  SavedRun run = read_frames_and_truth(path);
  run.path = read_tum_trajectory(folder.trajectory());
  run.keyframes = read_if_there(folder.keyframes());
  if (fs::exists(folder.map())) run.cloud = read_ply(folder.map());
  if (fs::exists(folder.run_json())) run.metrics = read_run_json(folder.run_json());
  read_mesh(path, run);
  if (fs::exists(folder.camera())) {
    const PinholeCamera camera = read_camera_file(folder.camera()).color;
    run.half_size_at_1m = {camera.width / camera.fx / 2, camera.height / camera.fy / 2};
  }
  run.loops = loops_of(run.metrics, run.keyframes);
  run.up = read_up_direction(run.metrics, run.path);
  return run;
}

constexpr size_t kFirstPieces = 1;   // of the cloud, which the first picture shows
constexpr size_t kBatchPieces = 16;  // a million points: they take a tenth of a second to encode

EncodedPart encode_piece(std::span<const CloudPiece> pieces, size_t index) {
  return {PartKind::kCloud, static_cast<uint32_t>(index), encode_cloud(pieces[index])};
}

/// The mesh, or the model of a file, which is sent as it is.
std::vector<EncodedPart> encode_surface(const SavedRun& run) {
  std::vector<EncodedPart> parts;
  if (!run.mesh.triangles.empty()) parts.push_back({PartKind::kMesh, 0, encode_mesh(run.mesh)});
  if (!run.model.empty()) parts.push_back({PartKind::kModel, 0, {run.model.begin(), run.model.end()}});
  return parts;
}

/// A stand-in for a large mesh, which takes long to send and to draw.
void show_coarsely(Scene& scene, const ColoredMesh& mesh) {
  constexpr size_t kLarge = 200'000, kCoarse = 20'000;  // triangles
  if (mesh.triangles.size() > kLarge) scene.put(PartKind::kMesh, 1, encode_mesh(coarse_mesh(mesh, kCoarse)));
}

/// The loops, and the map that they can be withdrawn from if it is known.
json loop_table(const SavedRun& run) {
  json table = {{"loops", to_json(run.loops)}};
  if (!run.map_file.empty()) table["map"] = run.map_file.string();
  return table;
}

/// Available colour modes; without times and camera positions, those modes are left out.
json colorings_of(const SavedRun& run) {
  const bool points = run.cloud.size() > 0;
  json colorings = json::array();
  if (run.colored || !points) colorings.push_back("camera");
  if (points) colorings.push_back("height");
  return colorings;
}

json status_of(const SavedRun& run, const std::optional<AteResult>& ate) {
  json status = {{"stage", "saved"}, {"up", {run.up.x(), run.up.y(), run.up.z()}}};
  if (ate) status["ateM"] = ate->error_m.rmse;
  if (!run.path.empty()) {
    status["frame"] = run.path.size();
    status["keyframes"] = run.keyframes.size();
    status["loops"] = accepted_pairs(run.loops).size();
  }
  if (run.cloud.size() > 0) status["points"] = run.cloud.size();
  if (!run.mesh.triangles.empty()) {
    status["vertices"] = run.mesh.points.size();
    status["triangles"] = run.mesh.triangles.size();
  }
  if (run.metrics.contains("landmarks")) status["landmarks"] = run.metrics["landmarks"];
  return status;
}

}  // namespace

std::vector<int64_t> doubt_of(std::span<const LoggedFrame> log) {
  std::vector<int64_t> doubt_ns;
  for (const LoggedFrame& entry : log) {
    if (entry.is_doubtful() || entry.is_lost()) doubt_ns.push_back(entry.stamp_ns);
  }
  return doubt_ns;
}

SavedRun read_frames_and_truth(const fs::path& path) {
  SavedRun run;
  if (!fs::is_directory(path)) return run;
  const auto folder = RunFolder::open_existing(path);
  run.truth = read_if_there(folder.ground_truth());
  if (fs::exists(folder.frames())) run.frames = read_frame_table(folder.frames());
  run.doubt_ns = doubt_of(run.frames);
  return run;
}

std::vector<TimelineFrame> timeline_of(const SavedRun& run, std::span<const PoseError> errors) {
  const auto place = index_by_stamp(run.path), keyframe = index_by_stamp(run.keyframes);
  const auto error = index_by_stamp(errors);
  std::vector<TimelineFrame> timeline;
  for (const FrameRow& row : run.frames.empty() ? frames_of_path(run) : run.frames) {
    TimelineFrame frame{.stamp_s = to_seconds(row.stamp_ns),
                        .status = frame_status(row.status),
                        .keyframe = {},
                        .tracked = static_cast<float>(row.tracked),
                        .sigma_m = static_cast<float>(row.sigma_m),
                        .ms = static_cast<float>(row.ms),
                        .error_m = 0,
                        .T_world_camera = {}};
    if (const auto at = keyframe.find(row.stamp_ns); at != keyframe.end())
      frame.keyframe = KeyframeId{at->second};
    if (const auto at = place.find(row.stamp_ns); at != place.end())
      frame.T_world_camera = run.path[at->second].T_world_camera;
    if (const auto at = error.find(row.stamp_ns); at != error.end())
      frame.error_m = static_cast<float>(errors[at->second].error_m);
    timeline.push_back(frame);
  }
  std::sort(timeline.begin(), timeline.end(),
            [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
  return timeline;
}

SavedRun read_saved_run(const fs::path& path) {
  SavedRun run = fs::is_directory(path) ? read_folder(path) : read_single_file(path);
  run.name = run_name(run.metrics, path);
  return run;
}

void show_first(Scene& scene, const SavedRun& run, std::span<const CloudPiece> pieces) {
  scene.put(PartKind::kHello, 0,
            encode_json({{"run", scene.run()},
                         {"input", run.name},
                         {"live", false},
                         {"colors", colorings_of(run)},
                         {"upKnown", run.up_known},
                         {"frustum", {run.half_size_at_1m.x(), run.half_size_at_1m.y()}}}));
  show_paths(scene, run);
  const auto ate = show_truth(scene, run);
  scene.put(PartKind::kStatus, 0, encode_json(status_of(run, ate)));
  for (size_t i = 0; i < std::min(kFirstPieces, pieces.size()); ++i) scene.put({encode_piece(pieces, i)});
  show_coarsely(scene, run.mesh);
  if (const auto timeline = timeline_of(run, ate ? ate->poses : std::vector<PoseError>()); !timeline.empty())
    scene.put(PartKind::kTimeline, 0, encode_timeline(timeline));
  if (!run.loops.empty()) scene.put(PartKind::kLoopTable, 0, encode_json(loop_table(run)));
}

size_t batch_count(std::span<const CloudPiece> pieces) {
  const size_t rest = pieces.size() - std::min(kFirstPieces, pieces.size());
  return (rest + kBatchPieces - 1) / kBatchPieces + 1;  // the last: the surface
}

std::vector<EncodedPart> encode_batch(const SavedRun& run, std::span<const CloudPiece> pieces, size_t index) {
  if (index + 1 == batch_count(pieces)) return encode_surface(run);
  const size_t begin = kFirstPieces + index * kBatchPieces;
  std::vector<EncodedPart> parts;
  for (size_t i = begin; i < std::min(pieces.size(), begin + kBatchPieces); ++i)
    parts.push_back(encode_piece(pieces, i));
  return parts;
}

void show_saved_run(Scene& scene, const SavedRun& run) {
  const std::vector<CloudPiece> pieces = split_into_pieces(run.cloud);
  show_first(scene, run, pieces);
  for (size_t i = 0; i < batch_count(pieces); ++i) scene.put(encode_batch(run, pieces, i));
}

void show_notice(Scene& scene, const SavedRun& run, const Notice& notice) {
  json status = status_of(run, absolute_trajectory_error(run.path, run.truth));
  status["message"] = notice.text;
  status["busy"] = notice.busy;
  scene.put(PartKind::kStatus, 0, encode_json(status));
}

}  // namespace kinloop
