#include "apps/run/run_warnings.hpp"

#include <fmt/format.h>

#include "kinloop/core/log.hpp"

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

/// Tells of skipped frames; returns whether they are at most half of all.
bool check_skipped(const FrameSource& source, size_t processed) {
  const auto skipped = source.skipped();
  if (skipped.empty()) return true;
  log::warn("{} skipped; the first: {}: {}",
            skipped.size() == 1 ? "1 frame was" : fmt::format("{} frames were", skipped.size()),
            skipped.front().name, skipped.front().reason);
  if (skipped.size() <= processed) return true;
  log::error("{}: over half of the frames could not be used ({} of {}); the results cover the others",
             source.info().name, skipped.size(), skipped.size() + processed);
  return false;
}

std::string describe_tracking_loss(const Map& map) {
  if (map.keyframes().empty()) return "no frame had enough keypoints with depth to initialise the map";
  return "tracking was lost and relocalisation failed";
}

}  // namespace

bool check_result(const RunOutcome& o, const Trajectory& trajectory, const DepthMonitor& depth) {
  const bool enough = check_skipped(o.source, o.slam.session_log().size());
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
  return enough && !useless;
}

ExitCode exit_code(const Slam& slam, int signal, const std::filesystem::path& details) {
  constexpr int kOfSignals = 128;
  if (signal != 0) return static_cast<ExitCode>(kOfSignals + signal);
  const auto log = slam.session_log();
  if (!log.empty() && is_tracked_in(slam.component(), log.back(), slam.map())) return ExitCode::kDone;
  log::error("{}; see {}", describe_tracking_loss(slam.map()), details.string());
  return ExitCode::kTrackingLost;
}

}  // namespace kinloop
