#pragma once
// In: the results of a run. Out: their files in its folder.

#include <string>

#include <nlohmann/json.hpp>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/io/covariance_file.hpp"
#include "kinloop/io/run_folder.hpp"

namespace kinloop {

/// A run's results, as values.
struct RunFiles {
  Trajectory trajectory;
  Trajectory keyframes;
  Trajectory ground_truth;                 ///< if empty, no file is written and an old one is removed
  ColoredCloud map;                        ///< in the world frame
  FileFrame frame;                         ///< of map.ply
  nlohmann::json metrics;                  ///< run.json; null: not written
  TrajectoryCovariances covariances = {};  ///< of the trajectory's poses
  std::string note = {};  ///< comment in trajectory.txt, see note_on_doubtful_poses; empty: none
};

/// Writes all of these files (camera.yaml, graph.g2o, frames.txt, loops and report.html are written
/// elsewhere).
void write_run_files(const RunFolder& folder, const RunFiles& files);

}  // namespace kinloop
