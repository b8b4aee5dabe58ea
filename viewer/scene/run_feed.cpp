#include "viewer/scene/run_feed.hpp"

#include <algorithm>

namespace kinloop {
namespace {

// More edges of covisibility would hide the map.
constexpr int kMinDrawnLandmarks = 60;
constexpr size_t kMaxDrawnNeighbors = 5;

MapSummary outline_of(const Map& map) {
  MapSummary summary;
  for (const Keyframe& keyframe : map.keyframes())
    summary.T_world_keyframe.push_back(keyframe.T_world_camera);
  for (const LoopEdge& edge : map.loop_edges()) summary.loops.emplace_back(edge.a, edge.b);
  summary.landmarks = map.landmark_count();
  return summary;
}

}  // namespace

void RunFeed::on_frame(const FrameResult& result, const PreparedFrame& frame) {
  const FrameEvent event{result.stamp_ns,           result.status,       result.relocalized, result.reference,
                         result.T_reference_camera, result.stats.inliers};
  ImageEvent image{result.keyframe, frame.color, frame.depth_m, frame.features, result.matches};
  const std::lock_guard lock(mutex_);
  events_.frames.push_back(event);
  if (result.keyframe.valid()) {
    if (events_.keyframes.size() == kMaxQueuedKeyframes) events_.keyframes.pop_front();
    events_.keyframes.push_back(image);
  }
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
    frames.push_back({entry.stamp_ns, entry.status, false, entry.reference, entry.T_reference_camera,
                      static_cast<int>(entry.observations.size())});
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
