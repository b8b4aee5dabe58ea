#include "session/store/rerun_parts.hpp"

#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "session/store/export_sparse_model.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// Rows of x y z and the quaternion x y z w, as in TUM format.
json poses_json(const Trajectory& trajectory) {
  json stamps_ns = json::array(), poses = json::array();
  for (const auto& [stamp_ns, pose] : trajectory) {
    const auto& [t, q] = std::pair(pose.translation, pose.rotation);
    stamps_ns.push_back(stamp_ns);
    poses.push_back({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
  }
  return {{"stamps_ns", stamps_ns}, {"poses", poses}};
}

json frames_json(std::span<const LoggedFrame> session) {
  json stamps_ns = json::array(), located = json::array(), doubtful = json::array();
  for (const LoggedFrame& frame : session) {
    stamps_ns.push_back(frame.stamp_ns);
    located.push_back(!frame.is_lost());
    doubtful.push_back(frame.is_doubtful());
  }
  return {{"stamps_ns", stamps_ns}, {"located", located}, {"doubtful", doubtful}};
}

json position_json(const Keyframe& keyframe) {
  const Eigen::Vector3d& p = keyframe.T_world_camera.translation;
  return {p.x(), p.y(), p.z()};
}

/// The positions of the two keyframes of each loop closure within the component. Stamps would not tell two
/// sessions of one recording apart.
json loops_json(const Map& map, uint32_t component) {
  json loops = json::array();
  for (const LoopClosure& loop : map.loop_closures()) {
    const Keyframe &a = map.keyframe(loop.a), &b = map.keyframe(loop.b);
    if (a.component == component && b.component == component)
      loops.push_back({position_json(a), position_json(b)});
  }
  return loops;
}

}  // namespace

void write_rerun_parts(const std::filesystem::path& folder, const RerunRequest& request,
                       const FileCloud& file, OpenMap& open, const Progress& progress) {
  require_images(open.views(request.session).size(), request.map);
  const uint32_t component = open.component(request.session);
  const auto session = open.session_log(request.session);
  // Map files do not keep covariances; the folder of a run has the uncertainty of each frame.
  const auto frame_table = std::filesystem::absolute(map_file_of(request.map)).parent_path() / "frames.txt";
  const json run = {
      {"name", open.saved.sessions.empty() ? request.map.string()
                                           : open.saved.sessions[open.session_index(request.session)].input},
      {"frame", to_json(file.frame)},
      {"trajectory", poses_json(open.poses.empty() ? trajectory_of(session, open.map) : open.poses)},
      {"keyframes", poses_json(keyframe_trajectory(open.map, component))},
      {"frames", frames_json(session)},
      {"frame_table", std::filesystem::exists(frame_table) ? frame_table.string() : ""},
      {"loops", loops_json(open.map, component)}};
  write_file(folder / "run.json", json_text(run));
  write_ply(folder / "cloud.ply", file.cloud, file.frame);
  export_sparse_model(
      {request.map, {}, folder, request.session, request.threads, request.images, 0, request.recording}, file,
      open, progress);  // last: it adds images to the map
}

}  // namespace kinloop
