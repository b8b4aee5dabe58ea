#include "viewer/saved/saved_map.hpp"

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/io/run_folder.hpp"
#include "viewer/report/report.hpp"

namespace kinloop {

bool is_map_file(const std::filesystem::path& path) {
  return path.extension() == std::filesystem::path(kMapFileName).extension();
}

void add_map(SavedRun& run, std::span<const LoggedFrame> session, const Map& map) {
  run.doubt_ns = doubt_of(session);
  for (const Keyframe& keyframe : map.keyframes()) {
    run.keyframes.push_back({keyframe.stamp_ns, keyframe.T_world_camera});
  }
  run.loops = loops_of(map);
  run.metrics["landmarks"] = map.landmark_count();
}

SavedRun saved_run_of(OpenMap& open) {
  SavedRun run;
  run.path = trajectory_of(open.session_log(0), open.map, DoubtfulPoses::kKept);
  add_map(run, open.session_log(0), open.map);
  run.up = open.up(0).direction;
  return run;
}

SavedRun read_shown(const std::filesystem::path& path, const Progress& progress) {
  if (!is_map_file(path)) {
    SavedRun run = read_saved_run(path);
    if (std::filesystem::exists(path / kMapFileName)) run.map_file = path / kMapFileName;
    return run;
  }
  OpenMap open = open_map(path, {});
  SavedRun run = saved_run_of(open);
  run.name = input_name(path.string());
  run.map_file = path;
  run.cloud = open.cloud(0, hardware_threads(), progress);
  return run;
}

}  // namespace kinloop
