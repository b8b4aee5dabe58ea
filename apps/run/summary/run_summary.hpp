#pragma once
// All figures of a run, as in run.json.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/map/map.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/input/checks/input_warning.hpp"
#include "session/input/recording_advisor.hpp"
#include "session/plan/run_plan.hpp"
#include "tools/evaluation/consistency.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

/// The results of a run.
struct RunOutcome {
  const RunPlan& plan;
  const Slam& slam;
  std::vector<InputWarning> warnings = {};          ///< where the input contradicts itself
  RecordingAdvisor advisor = {};                    ///< what spoiled the recording
  std::optional<Evaluation> evaluation = {};        ///< if there is ground truth
  std::vector<PoseWithCovariance> live_poses = {};  ///< as tracking gave them
  std::optional<size_t> map_points = {};            ///< of the cloud, if one was fused
  std::vector<double> latencies_ms = {};            ///< from images to poses
  std::vector<double> ages_ms = {};                 ///< from stamps to poses, of a live camera
  double wall_s = 0;
  bool interrupted = false;  ///< or ended by a failing source
};

/// Returns the content of run.json but for timings.
nlohmann::json run_summary(const RunOutcome& outcome);

/// Adds `timings`, the time of each module of the library and of the program, and `cpu_s`, the CPU time of
/// the process until now.
void add_timings(nlohmann::json& summary, const Timings& slam, const Timings& program);

/// Returns a table of CPU time per module, largest first, from run.json: --profile.
std::string profile_text(const nlohmann::json& summary);

/// Returns the lines printed at the end of a run.
std::string summary_text(const nlohmann::json& summary);

/// Returns the verdict, the last line: "quality: doubtful: 3.2 s of 33.3 s are in doubt (...)".
std::string quality_text(const nlohmann::json& summary);

/// Returns the robust standard deviation of the residuals of depth in units of the noise at keypoints,
/// at the poses, points, velocities and sensor of `problem`: 1 if the model is right. Only
/// observations whose pixel is an inlier count, whatever their depth. nullopt if they are too few.
///
/// It is the median of the absolute differences of two residuals of one point / (0.6745 sqrt(2)) (Shamos
/// 1976, "Geometry and statistics: problems at the interface"). The residuals themselves are too small: a
/// robust fit puts many points exactly at one of their depths. A point's error cancels in the differences.
std::optional<double> depth_noise_scale(const BundleProblem& problem);

/// Same for the keypoints of all keyframes of a run that has finished.
std::optional<double> depth_noise_scale(const Slam& slam);

/// Returns a list of objects: the stamps of both keyframes, inliers, the keyframes that agree (`support`),
/// the relative scale (null if unknown), `status` and `reason`.
nlohmann::json loops_json(const std::vector<LoopClosure>& loops, const Map& map);

}  // namespace kinloop
