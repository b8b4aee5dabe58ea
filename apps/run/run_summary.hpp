#pragma once
// All figures of a run, as in run.json.

#include <optional>
#include <span>

#include <nlohmann/json.hpp>

#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/run_options.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

/// The results of a run.
struct RunOutcome {
  const FrameSource& source;
  const Slam& slam;
  const RunOptions& options;
  std::optional<Evaluation> evaluation;  ///< if there is ground truth
  std::optional<size_t> map_points;      ///< of the cloud, if one was fused
  double wall_s = 0;
  int threads = 1;
  bool interrupted = false;
  size_t dropped = 0;  ///< frames dropped in live mode
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

}  // namespace kinloop
