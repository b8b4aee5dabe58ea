#include "viewer/saved_map.hpp"

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/io/run_folder.hpp"
#include "viewer/report/report.hpp"

namespace kinloop {

bool is_map_file(const std::filesystem::path& path) {
  return path.extension() == std::filesystem::path(kMapFileName).extension();
}

SavedRun saved_run_of(OpenMap& open) {
  SavedRun run;
  run.path = trajectory_of(open.session_log(0), open.map, DoubtfulPoses::kKept);
  run.doubt_ns = doubt_of(open.session_log(0));
  for (const Keyframe& keyframe : open.map.keyframes()) {
    run.keyframes.push_back({keyframe.stamp_ns, keyframe.T_world_camera});
  }
  for (const LoopClosure& loop : open.map.loop_closures()) run.loops.emplace_back(loop.a, loop.b);
  run.metrics["landmarks"] = open.map.landmark_count();
  run.up = open.up(0).direction;
  return run;
}

SavedRun read_saved_map(const std::filesystem::path& file, const Progress& progress) {
  OpenMap open = open_map(file, {});
  SavedRun run = saved_run_of(open);
  run.name = input_name(file.string());
  run.cloud = open.cloud(0, hardware_threads(), progress);
  return run;
}

}  // namespace kinloop
