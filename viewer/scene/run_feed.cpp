#include "viewer/scene/run_feed.hpp"

#include <algorithm>

namespace kinloop {
namespace {

MapNews outline_of(const Map& map) {
  MapNews news;
  for (const Keyframe& keyframe : map.keyframes()) news.T_world_keyframe.push_back(keyframe.T_world_camera);
  for (const LoopEdge& edge : map.loop_edges()) news.loops.emplace_back(edge.a, edge.b);
  news.landmarks = map.landmark_count();
  return news;
}

}  // namespace

void RunFeed::on_frame(const FrameResult& result, const PreparedFrame& frame) {
  const FrameNews news{result.stamp_ns,           result.status,       result.relocalized, result.reference,
                       result.T_reference_camera, result.stats.inliers};
  ImageNews image{result.keyframe, frame.color, frame.depth_m, frame.features, result.matches};
  const std::lock_guard lock(mutex_);
  news_.frames.push_back(news);
  if (result.keyframe.valid()) {
    if (news_.keyframes.size() == kMostKeyframesWaiting) news_.keyframes.pop_front();
    news_.keyframes.push_back(image);
  }
  news_.latest = std::move(image);
}

void RunFeed::on_map(const Map& map) {
  MapNews outline = outline_of(map);
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible;
  for (; keyframes_told_ < map.keyframes().size(); ++keyframes_told_) {
    const KeyframeId newer = map.keyframes()[keyframes_told_].id;
    const auto neighbors = map.covisible(newer, options_.min_shared);
    const size_t count = std::min(neighbors.size(), static_cast<size_t>(options_.max_neighbors));
    for (size_t i = 0; i < count; ++i) covisible.emplace_back(neighbors[i].first, newer);
  }
  const std::lock_guard lock(mutex_);
  news_.map = std::move(outline);
  news_.covisible.insert(news_.covisible.end(), covisible.begin(), covisible.end());
}

void RunFeed::on_finish(std::span<const LoggedFrame> log, const Map& map) {
  std::vector<FrameNews> frames;
  for (const LoggedFrame& entry : log) {
    frames.push_back({entry.stamp_ns, entry.status, false, entry.reference, entry.T_reference_camera,
                      static_cast<int>(entry.observations.size())});
  }
  MapNews outline = outline_of(map);
  const std::lock_guard lock(mutex_);
  news_.from_start = true;
  news_.frames = std::move(frames);
  news_.map = std::move(outline);
}

RunNews RunFeed::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(news_, {});
}

}  // namespace kinloop
