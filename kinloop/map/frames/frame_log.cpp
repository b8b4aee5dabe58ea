#include "kinloop/map/frames/frame_log.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "kinloop/map/frames/pose_covariance.hpp"

namespace kinloop {
namespace {

/// The images of a lost frame are gone; its features can still be matched.
std::shared_ptr<const Frame> without_images(const Frame& frame) {
  Frame kept;
  kept.id = frame.id;
  kept.stamp_ns = frame.stamp_ns;
  kept.features = frame.features;
  kept.surfaces = frame.surfaces;
  return std::make_shared<const Frame>(std::move(kept));
}

std::vector<MatchMeasurement> measurements_of(const std::vector<LandmarkMatch>& matches,
                                              const Features& features, int image_height_px) {
  std::vector<MatchMeasurement> measurements;
  measurements.reserve(matches.size());
  for (const auto& [landmark, feature] : matches) {
    MatchMeasurement measured;
    measured.pixel = features.measured_pixels[feature];
    measured.depth_m = features.measured_depths_m[feature];
    measured.sigma_px = features.sigmas_px[feature];
    measured.row = features.raw_pixels[feature].y() / static_cast<float>(image_height_px) - 0.5F;
    if (!features.inverse_depth_gradients.empty())
      measured.inverse_depth_gradient = features.inverse_depth_gradients[feature];
    measurements.push_back(measured);
  }
  return measurements;
}

/// Calls `use` with each frame whose pose belongs to the trajectory.
template <class Use>
void for_frames_of_trajectory(std::span<const LoggedFrame> log, const Map& map, DoubtfulPoses doubtful,
                              const Use& use) {
  const uint32_t component = main_component(log, map);
  for (const LoggedFrame& entry : log) {
    if (!is_tracked_in(component, entry, map)) continue;
    if (entry.is_doubtful() && doubtful == DoubtfulPoses::kLeftOut) continue;
    use(entry);
  }
}

}  // namespace

void lose(LoggedFrame& frame) {
  lose(static_cast<EstimatedFrame&>(frame));
  frame.measurements.clear();
}

LoggedFrame log_entry(const TrackedFrame& tracked, int image_height_px) {
  LoggedFrame entry;
  static_cast<EstimatedFrame&>(entry) = tracked;
  entry.measurements = measurements_of(tracked.matches, tracked.features(), image_height_px);
  if (tracked.is_lost()) entry.lost = without_images(*tracked.frame);
  return entry;
}

FrameLog relocalize_lost_frames(FrameLog log, int image_height_px, const FrameSearch& search) {
  const auto relocalize = [&](LoggedFrame& entry, const auto& find) {
    if (!entry.is_lost() || !entry.lost) return;
    std::optional<TrackedFrame> found = find(*entry.lost);
    if (!found) return;
    found->frame = entry.lost;
    found->evidence.input = entry.evidence.input;
    // Colour alone supports it, as in the frames around, and no later frame confirms it.
    if (entry.evidence.input.depth_factor == 0) doubt(*found, DoubtCause::kNoDepth);
    entry = log_entry(*found, image_height_px);
  };
  const auto search_near = [&](size_t i, size_t neighbor) {
    if (!log[neighbor].is_tracked_by_landmarks()) return;
    relocalize(log[i], [&](const Frame& frame) { return search.nearby(frame, log[neighbor]); });
  };
  for (LoggedFrame& entry : log) relocalize(entry, search.anywhere);
  for (size_t i = log.size(); i-- > 1;) search_near(i - 1, i);
  for (size_t i = 1; i < log.size(); ++i) search_near(i, i - 1);
  return log;
}

namespace {

/// Drops the matches of landmarks that are not in this component.
void keep_matches_of(uint32_t component, LoggedFrame& frame, const Map& map) {
  std::vector<LandmarkMatch> matches;
  std::vector<MatchMeasurement> measurements;
  for (size_t i = 0; i < frame.matches.size(); ++i) {
    const LandmarkId landmark = map.resolve_merged(frame.matches[i].landmark);
    if (map.contains(landmark) && map.keyframe(map.landmark(landmark).anchor).component != component)
      continue;
    matches.push_back(frame.matches[i]);
    if (i < frame.measurements.size()) measurements.push_back(frame.measurements[i]);
  }
  frame.matches = std::move(matches);
  frame.measurements = std::move(measurements);
}

/// Expresses the poses of frames relative to keyframes of their own visit, and calls `use` with each frame
/// and its component.
template <class Frame, class Use>
void rebase(std::vector<Frame>& frames, const Map& map, std::span<const SE3> T_world_keyframe_before,
            const Use& use) {
  KeyframeId own;
  for (Frame& frame : frames) {
    if (frame.is_lost()) continue;
    if (frame.outcome == TrackingOutcome::kRelocalized) own = frame.reference;
    if (frame.keyframe.valid()) own = frame.keyframe;
    if (!own.valid() || !frame.reference.valid()) continue;
    const uint32_t component = map.keyframe(own).component;
    if (map.keyframe(frame.reference).component != component) {
      const SE3 T_own_reference =
          T_world_keyframe_before[own.value].inverse() * T_world_keyframe_before[frame.reference.value];
      frame.T_reference_camera = T_own_reference * frame.T_reference_camera;
      frame.reference = own;
    }
    use(frame, component);
  }
}

}  // namespace

FrameLog rebased_after_split(FrameLog log, const Map& map, std::span<const SE3> T_world_keyframe_before) {
  rebase(log, map, T_world_keyframe_before,
         [&](LoggedFrame& frame, uint32_t component) { keep_matches_of(component, frame, map); });
  return log;
}

std::vector<FrameRecord> rebased_after_split(std::vector<FrameRecord> frames, const Map& map,
                                             std::span<const SE3> T_world_keyframe_before) {
  rebase(frames, map, T_world_keyframe_before, [](const FrameRecord&, uint32_t) {});
  return frames;
}

uint32_t main_component(std::span<const LoggedFrame> log, const Map& map) {
  std::vector<int> frames(map.component_count() + 1, 0);
  for (const LoggedFrame& entry : log) {
    if (!entry.is_lost()) ++frames[map.keyframe(entry.reference).component];
  }
  return static_cast<uint32_t>(std::max_element(frames.begin(), frames.end()) - frames.begin());
}

void doubt(FrameRecord& frame, DoubtCause cause) {
  const bool weighs_more = is_weak_evidence(frame.trust.cause) && !is_weak_evidence(cause);
  if (cause != DoubtCause::kNone && (!frame.is_doubtful() || weighs_more)) frame.trust.cause = cause;
}

bool is_tracked_in(uint32_t component, const FrameRecord& frame, const Map& map) {
  return !frame.is_lost() && map.keyframe(frame.reference).component == component;
}

Trajectory trajectory_of(std::span<const LoggedFrame> log, const Map& map, DoubtfulPoses doubtful) {
  Trajectory trajectory;
  for_frames_of_trajectory(log, map, doubtful, [&](const LoggedFrame& entry) {
    trajectory.push_back({entry.stamp_ns, entry.world(map)});
  });
  return trajectory;
}

std::vector<std::optional<Matrix6d>> covariances_of(std::span<const LoggedFrame> log, const Map& map,
                                                    DoubtfulPoses doubtful) {
  std::vector<std::optional<Matrix6d>> covariances;
  for_frames_of_trajectory(log, map, doubtful,
                           [&](const LoggedFrame& entry) { covariances.push_back(pose_covariance(entry)); });
  return covariances;
}

long count_doubtful_poses(std::span<const LoggedFrame> log, const Map& map) {
  const uint32_t component = main_component(log, map);
  return std::count_if(log.begin(), log.end(), [&](const LoggedFrame& entry) {
    return entry.is_doubtful() && is_tracked_in(component, entry, map);
  });
}

std::string note_on_doubtful_poses(std::span<const LoggedFrame> log, const Map& map, DoubtfulPoses doubtful) {
  const long count = count_doubtful_poses(log, map);
  if (count == 0) return {};
  const char* poses = count == 1 ? "pose" : "poses";
  return doubtful == DoubtfulPoses::kKept ? fmt::format("with {} doubtful {}", count, poses)
                                          : fmt::format("{} doubtful {} left out", count, poses);
}

Trajectory keyframe_trajectory(const Map& map, uint32_t component) {
  Trajectory trajectory;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.component != component) continue;
    trajectory.push_back({keyframe.stamp_ns, keyframe.T_world_camera});
  }
  return trajectory;
}

}  // namespace kinloop
