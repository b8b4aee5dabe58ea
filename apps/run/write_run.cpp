#include "apps/run/write_run.hpp"

#include "apps/run/loop_pictures.hpp"
#include "apps/shared/report_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/optimize/pose_graph/g2o_file/g2o_file.hpp"
#include "kinloop/sensor/camera_file.hpp"
#include "viewer/report/run_up_direction.hpp"

namespace kinloop {
namespace {

nlohmann::json summary_of(const RunContents& contents) {
  auto summary = run_summary(contents.outcome);
  if (!contents.map_file.is_null()) summary["map_file"] = contents.map_file;
  if (!contents.map) return summary;
  summary["up"] = to_json(contents.map->up);
  summary["map"].update(to_json(contents.map->frame));
  return summary;
}

/// Writes everything but run.json and the report.
void write_results(const RunFolder& folder, const RunContents& contents) {
  write_frame_table(folder.frames(), contents.frames);
  if (!contents.map) return write_tum_trajectory(folder.trajectory(), contents.trajectory);
  const Slam& slam = contents.outcome.slam;
  const FrameSource& source = contents.outcome.source;
  write_run_files(folder, {contents.trajectory, keyframe_trajectory(slam.map(), slam.component()),
                           source.info().ground_truth, contents.map->cloud, contents.map->frame, nullptr});
  write_camera_file(folder.camera(), calibrated_camera(source.camera(), slam.sensor_estimate()));
  write_g2o(folder.graph(), {make_pose_graph(slam.map(), contents.outcome.options.slam.loop), {}, true, {}});
  write_loop_pictures(folder, slam, contents.images);
}

}  // namespace

nlohmann::json write_run(const RunFolder& folder, RunContents contents) {
  const Stopwatch writing;
  auto summary = summary_of(contents);
  write_results(folder, contents);
  contents.program.add("writing", writing.elapsed());
  add_timings(summary, contents.outcome.slam.timings(), contents.program);
  write_file(folder.run_json(), json_text(summary, 2) + "\n");
  if (contents.map) write_report(folder);
  return summary;
}

}  // namespace kinloop
