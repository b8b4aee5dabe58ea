#include "kinloop/back_end/final/refine_frames.hpp"

#include <algorithm>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/map/frames/frame_velocities.hpp"
#include "kinloop/optimize/pose/moving_pose.hpp"

namespace kinloop {
namespace {

KeypointMeasurement measurement_of(const MatchMeasurement& seen, float depth_stamp_difference_s) {
  KeypointMeasurement o;
  o.depth_stamp_difference_s = static_cast<double>(depth_stamp_difference_s);
  o.pixel = seen.pixel.cast<double>();
  o.depth_m = static_cast<double>(seen.depth_m);
  o.sigma_px = static_cast<double>(seen.sigma_px);
  o.row = static_cast<double>(seen.row);
  o.inverse_depth_gradient = seen.inverse_depth_gradient.cast<double>();
  return o;
}

std::vector<PoseObservation> pose_observations(const LoggedFrame& entry, const Map& map) {
  std::vector<PoseObservation> observations;
  for (size_t i = 0; i < entry.measurements.size(); ++i) {
    const LandmarkId landmark = map.resolve_merged(entry.matches[i].landmark);
    if (!map.contains(landmark)) continue;
    observations.push_back(
        {measurement_of(entry.measurements[i], entry.depth_stamp_difference_s), map.p_world(landmark)});
  }
  return observations;
}

/// A pose relative to the reference keyframe, with its covariance given the landmarks.
struct RefinedPose {
  SE3 T_reference_camera;
  Matrix6d covariance;
};

/// Returns the refined pose of frame `i`, or the present one if it has nothing to refine.
RefinedPose refined_pose(const FrameLog& log, size_t i, const FrameRefinement& refinement) {
  const LoggedFrame& entry = log[i];
  if (entry.keyframe.valid() || entry.is_repeat() || entry.measurements.empty() ||
      !entry.is_tracked_by_landmarks())
    return {entry.T_reference_camera, entry.covariance};
  // A frame keeps its tracked pose if few of its landmarks are left or a correction moved them apart. Many
  // may have been culled, since a frame between keyframes is tracked against landmarks of the newest one.
  constexpr size_t kMinInliers = 20;
  const Map& map = refinement.map;
  const auto observations = pose_observations(entry, map);
  AbsolutePoseOptions strict = refinement.options;
  strict.min_inliers = static_cast<int>(std::max(kMinInliers, observations.size() / 2 + 1));
  const RollingShutterPose guess{entry.world(map), frame_velocity(log, i, map)};
  const auto found = solve_rolling_shutter_pose(refinement.sensor, observations, guess, {}, strict);
  const SE3 T_world_camera = found ? found->T_world_camera : guess.T_world_camera;
  return {map.keyframe(entry.reference).T_world_camera.inverse() * T_world_camera,
          found ? found->covariance : entry.covariance};
}

/// Returns 1 for the frames on whose poses the velocities of keyframes depend: the nearest before and after
/// each that do not repeat an image.
std::vector<uint8_t> neighbours_of_keyframes(const FrameLog& log) {
  std::vector<uint8_t> marked(log.size(), 0);
  size_t previous = 0;  // the last frames that are not repeated
  bool after_keyframe = false;
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].is_repeat()) continue;
    if (after_keyframe) marked[i] = 1;
    after_keyframe = log[i].keyframe.valid();
    if (after_keyframe) marked[previous] = 1;
    previous = i;
  }
  return marked;
}

}  // namespace

FrameLog refine_frames(FrameLog log, const FrameRefinement& refinement, FrameSelection which, int threads) {
  const auto selected = which == FrameSelection::kNearKeyframes ? neighbours_of_keyframes(log)
                                                                : std::vector<uint8_t>(log.size(), 1);
  std::vector<RefinedPose> refined(log.size());
  parallel_for(log.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      refined[i] = selected[i] == 0 ? RefinedPose{log[i].T_reference_camera, log[i].covariance}
                                    : refined_pose(log, i, refinement);
    }
  });
  for (size_t i = 0; i < log.size(); ++i) {
    LoggedFrame& entry = log[i];
    entry.T_reference_camera = refined[i].T_reference_camera;
    entry.covariance = refined[i].covariance;
    if (entry.keyframe.valid()) {
      entry.reference = entry.keyframe;
      entry.T_reference_camera = SE3{};
    } else if (entry.is_repeat()) {
      entry.reference = log[i - 1].reference;
      entry.T_reference_camera = log[i - 1].T_reference_camera;
    }
  }
  return log;
}

void LogLimiter::apply(FrameLog& log, size_t first, const FrameRefinement& refinement) {
  if (log.back().lost) lost_.push_back(log.size() - 1);
  if (lost_.size() > limits_.lost_frames) {
    log[lost_.front()].lost.reset();
    lost_.pop_front();
  }
  if (log.size() - first <= limits_.refinable_frames) return;
  const size_t oldest = log.size() - 1 - limits_.refinable_frames;
  LoggedFrame& entry = log[oldest];
  const RefinedPose refined = refined_pose(log, oldest, refinement);
  entry.T_reference_camera = refined.T_reference_camera;
  entry.covariance = refined.covariance;
  entry.refined = !entry.measurements.empty();
  entry.matches = std::vector<LandmarkMatch>();  // frees its memory, unlike {}
  entry.measurements = std::vector<MatchMeasurement>();
}

}  // namespace kinloop
