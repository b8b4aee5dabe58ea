#include "apps/export/export_map_recording.hpp"

#include <algorithm>
#include <unordered_map>

#include "tools/export/mcap/map_recording.hpp"

namespace kinloop {
namespace {

/// Returns those of `views` that belong to the session, in order of time.
std::vector<StampedImage> session_images(std::span<const TrackedFrame> session, const OpenMap& open,
                                         std::span<const PosedImage> views) {
  std::unordered_map<FrameId, int64_t> stamp_of;
  for (const TrackedFrame& entry : session) stamp_of.emplace(entry.id, entry.stamp_ns);
  std::vector<StampedImage> images;
  for (const PosedImage& view : views) {
    const auto stamp = stamp_of.find(open.recorder.frame_of_image(view.image));
    if (stamp != stamp_of.end()) images.push_back({stamp->second, view.image});
  }
  std::stable_sort(images.begin(), images.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return images;
}

}  // namespace

void export_map_recording(const MapRecordingRequest& request, OpenMap& open, const Progress& progress) {
  const auto session = open.session_log(request.session);
  const auto views = open.views(request.session);
  MapRecording recording;
  recording.trajectory = open.poses.empty() ? trajectory_of(session, open.map) : open.poses;
  recording.images = session_images(session, open, views);
  recording.cloud = open.cloud(request.session, request.threads, progress);
  recording.camera = open.dense_camera().color;
  recording.frame = file_frame(request.frame, open.up(request.session), views);
  write_map_recording(request.file, recording,
                      [&](size_t image) { return open.recorder.images().encoded(image).color; });
}

}  // namespace kinloop
