#pragma once
// Every figure of a run, as run.json holds it.

#include <optional>
#include <span>

#include <nlohmann/json.hpp>

#include "apps/run/run_options.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/slam.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

/// What a run ended with.
struct RunOutcome {
  const FrameSource& source;
  const Slam& slam;
  const RunOptions& options;
  std::optional<Evaluation> evaluation;  ///< where there is ground truth
  std::optional<size_t> map_points;      ///< of the cloud, where one was made
  double wall_s = 0;
  int threads = 1;
  bool interrupted = false;
  size_t dropped = 0;  ///< frames lost for want of time, live
};

/// What each module spent.
nlohmann::json timings_json(const Timings& times);

nlohmann::json run_summary(const RunOutcome& outcome);

/// The lines printed at the end of a run.
std::string summary_text(const nlohmann::json& summary);

}  // namespace kinloop
