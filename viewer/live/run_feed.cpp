#include <algorithm>

#include "viewer/live/run_scene.hpp"

namespace kinloop {
namespace {

// More edges of covisibility would hide the map.
constexpr int kMinDrawnLandmarks = 60;
constexpr size_t kMaxDrawnNeighbors = 5;

MapSummary outline_of(const Map& map) {
  MapSummary summary;
  for (const Keyframe& keyframe : map.keyframes())
    summary.T_world_keyframe.push_back(keyframe.T_world_camera);
  for (const LoopClosure& edge : map.loop_closures()) summary.loops.emplace_back(edge.a, edge.b);
  summary.landmarks = map.landmark_count();
  return summary;
}

FrameEvent event_of(const FrameRecord& tracked, int inliers) {
  return {tracked.stamp_ns,           tracked.outcome, tracked.method,       tracked.reference,
          tracked.T_reference_camera, inliers,         tracked.is_doubtful()};
}

MeshFrame mesh_frame_of(const TrackedFrame& tracked) {
  if (tracked.keyframe.valid())
    return {tracked.frame, tracked.keyframe, SE3(), tracked.velocity, tracked.moved, true};
  return {tracked.frame, tracked.reference, tracked.T_reference_camera, tracked.velocity, tracked.moved};
}

/// Appends to a queue that drops its oldest entry when it is full.
template <class Event>
void push_bounded(std::deque<Event>& queue, Event event, size_t most) {
  if (queue.size() == most) queue.pop_front();
  queue.push_back(std::move(event));
}

}  // namespace

/// A frame whose pose may be wrong would spoil what others have measured.
bool RunFeed::is_for_mesh(const TrackedFrame& tracked) {
  if (tracked.is_lost() || tracked.is_doubtful() || tracked.provisional) return false;
  if (!tracked.keyframe.valid() && ++frames_since_mesh_frame_ < kMeshFrameStep) return false;
  frames_since_mesh_frame_ = 0;
  return true;
}

void RunFeed::on_frame(const TrackedFrame& tracked) {
  const FrameEvent event = event_of(tracked, tracked.evidence.inliers);
  ImageEvent image{tracked.keyframe, tracked.frame, tracked.matches, tracked.moved};
  const bool for_mesh = is_for_mesh(tracked);
  const std::lock_guard lock(mutex_);
  events_.frames.push_back(event);
  if (for_mesh) push_bounded(events_.mesh_frames, mesh_frame_of(tracked), kMaxQueuedKeyframes);
  if (tracked.keyframe.valid()) push_bounded(events_.keyframes, image, kMaxQueuedKeyframes);
  events_.latest = std::move(image);
}

void RunFeed::on_map(const Map& map) {
  MapSummary outline = outline_of(map);
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible;
  for (; keyframes_reported_ < map.keyframes().size(); ++keyframes_reported_) {
    const KeyframeId newer = map.keyframes()[keyframes_reported_].id;
    const auto neighbors = map.covisible_keyframes(newer, kMinDrawnLandmarks);
    const size_t count = std::min(neighbors.size(), kMaxDrawnNeighbors);
    for (size_t i = 0; i < count; ++i) covisible.emplace_back(neighbors[i].first, newer);
  }
  const std::lock_guard lock(mutex_);
  events_.map = std::move(outline);
  events_.covisible.insert(events_.covisible.end(), covisible.begin(), covisible.end());
}

void RunFeed::on_finish(std::span<const LoggedFrame> log, const Map& map) {
  std::vector<FrameEvent> frames;
  for (const LoggedFrame& entry : log) {
    frames.push_back(event_of(entry, static_cast<int>(entry.measurements.size())));
    // A finished run has no news.
    if (!entry.is_lost()) frames.back().outcome = TrackingOutcome::kTracked;
  }
  MapSummary outline = outline_of(map);
  const std::lock_guard lock(mutex_);
  events_.replaces_all = true;
  events_.frames = std::move(frames);
  events_.map = std::move(outline);
}

RunEvents RunFeed::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

}  // namespace kinloop
