#include "apps/run_warnings.hpp"

#include <fmt/format.h>

#include "kinloop/base/log.hpp"

namespace kinloop {

namespace {

/// Why a map has no point though its depth is in range.
std::string why_empty(const RunOutcome& o) {
  if (o.slam.map().keyframes().empty()) return "no frame was located";
  const DenseOptions& dense = o.options.dense;
  return fmt::format(
      "no surface was seen by {} images (dense.min_observations), less steeply than {} degrees "
      "(dense.max_slope_deg) and not through (dense.carve)",
      dense.min_observations, dense.max_slope_deg);
}

}  // namespace

bool judge_result(const RunOutcome& o, const Trajectory& trajectory, const DepthWatch& depth) {
  const std::string complaint = depth.complaint();
  const bool empty = o.map_points && *o.map_points == 0;  // else no cloud was asked for
  const bool useless = !complaint.empty() && (depth.unusable() || empty);
  if (useless) {
    log::error("the map is of no use: {}", complaint);
  } else if (!complaint.empty()) {
    log::warn("{}", complaint);
  } else if (empty && !o.slam.session_log().empty()) {
    log::warn("the map has no point: {}", why_empty(o));
  }
  const Trajectory& truth = o.source.info().ground_truth;
  if (!o.evaluation && !truth.empty() && !trajectory.empty())
    log::warn("the ground truth tells no error: {}", why_not_evaluated(trajectory, truth));
  return !useless;
}

std::string loss_text(const Map& map) {
  if (map.keyframes().empty()) return "no frame had enough key points with depth to begin with";
  return "tracking was lost and its place not recognised again";
}

}  // namespace kinloop
