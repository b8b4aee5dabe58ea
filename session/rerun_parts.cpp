#include "session/rerun_parts.hpp"

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/io/point_cloud/ply.hpp"
#include "kinloop/map/frame_log.hpp"
#include "session/export_sparse_model.hpp"

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

json frames_json(std::span<const TrackedFrame> session) {
  json stamps_ns = json::array(), located = json::array(), doubtful = json::array();
  for (const TrackedFrame& frame : session) {
    stamps_ns.push_back(frame.stamp_ns);
    located.push_back(!frame.is_lost());
    doubtful.push_back(frame.doubtful);
  }
  return {{"stamps_ns", stamps_ns}, {"located", located}, {"doubtful", doubtful}};
}

/// The stamps of the two keyframes of each loop closure.
json loop_stamps_json(const Map& map) {
  json loops = json::array();
  for (const LoopClosure& loop : map.loop_closures())
    loops.push_back({map.keyframe(loop.a).stamp_ns, map.keyframe(loop.b).stamp_ns});
  return loops;
}

}  // namespace

void write_rerun_parts(const std::filesystem::path& folder, const RerunRequest& request, OpenMap& open,
                       const Progress& progress) {
  const auto views = open.views(request.session);
  require_images(views.size(), request.map);
  const FileFrame frame = file_frame(request.frame, open.up(request.session), views);
  const auto session = open.session_log(request.session);
  const json run = {
      {"name", open.saved.sessions.empty() ? request.map.string()
                                           : open.saved.sessions[open.session_index(request.session)].input},
      {"frame", to_json(frame)},
      {"trajectory", poses_json(open.poses.empty() ? trajectory_of(session, open.map) : open.poses)},
      {"keyframes", poses_json(keyframe_trajectory(open.map, open.component(request.session)))},
      {"frames", frames_json(session)},
      {"loops", loop_stamps_json(open.map)}};
  write_file(folder / "run.json", json_text(run));
  // Map files do not keep covariances; the folder of a run has the uncertainty of each frame.
  const auto frame_table = map_file_of(request.map).parent_path() / "frames.txt";
  if (std::filesystem::exists(frame_table)) write_file(folder / "frames.txt", read_file(frame_table));
  write_ply(folder / "cloud.ply", open.cloud(request.session, request.threads, progress), frame);
  export_sparse_model({request.map,
                       {},
                       folder,
                       request.frame,
                       request.session,
                       request.threads,
                       request.images,
                       0,
                       request.recording},
                      open, progress);  // last: it adds images to the map
}

}  // namespace kinloop
