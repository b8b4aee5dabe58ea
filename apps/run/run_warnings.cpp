#include "apps/run/run_warnings.hpp"

#include <fmt/format.h>

#include "kinloop/base/log.hpp"

namespace kinloop {

namespace {

/// Explains why a map has no points although its depth is in range.
std::string explain_empty_map(const RunOutcome& o) {
  if (o.slam.map().keyframes().empty()) return "no frame was located";
  const DenseOptions& dense = o.options.dense;
  return fmt::format(
      "no surface was observed by {} images (dense.min_observations) at less than {} degrees "
      "(dense.max_incidence_deg) without free-space violation (dense.carve)",
      dense.min_observations, dense.limits.max_incidence_deg);
}

}  // namespace

bool check_result(const RunOutcome& o, const Trajectory& trajectory, const DepthMonitor& depth) {
  const std::string problem = depth.problem();
  const bool empty = o.map_points && *o.map_points == 0;  // otherwise no cloud was requested
  const bool useless = !problem.empty() && (depth.unusable() || empty);
  if (useless) {
    log::error("the map is unusable: {}", problem);
  } else if (!problem.empty()) {
    log::warn("{}", problem);
  } else if (empty && !o.slam.session_log().empty()) {
    log::warn("the map has no points: {}", explain_empty_map(o));
  }
  const Trajectory& truth = o.source.info().ground_truth;
  if (!o.evaluation && !truth.empty() && !trajectory.empty())
    log::warn("trajectory error not computed: {}", evaluation_failure(trajectory, truth));
  return !useless;
}

std::string describe_tracking_loss(const Map& map) {
  if (map.keyframes().empty()) return "no frame had enough keypoints with depth to initialise the map";
  return "tracking was lost and relocalisation failed";
}

}  // namespace kinloop
