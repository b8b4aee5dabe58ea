#include "apps/dense_recorder.hpp"

#include <algorithm>
#include <unordered_map>

namespace kinloop {
namespace {

ImageStoreOptions store_options(const RgbdCamera& camera, const DenseOptions& options) {
  ImageStoreOptions store;
  store.depth_scale = camera.depth_scale;
  store.jpeg_quality = options.jpeg_quality;
  store.memory_limit_bytes = static_cast<size_t>(options.image_memory_mib) << 20;
  return store;
}

}  // namespace

DenseRecorder::DenseRecorder(const RgbdCamera& camera, const DenseOptions& options)
    : camera_(camera), options_(options), images_(store_options(camera, options)) {}

void DenseRecorder::on_frame(const FrameResult& result, const PreparedFrame& frame) {
  if (result.status == TrackStatus::kLost) return;
  const bool in_step =
      options_.frame_step > 0 && result.frame.value % static_cast<uint32_t>(options_.frame_step) == 0;
  if (!result.keyframe.valid() && !in_step) return;
  images_.add(frame.color, frame.depth_m);
  frame_of_image_.push_back(result.frame);
}

void DenseRecorder::restore(const SavedImages& saved) {
  // Images of another size would not go with the camera.
  if (saved.images.rows != camera_.color.height || saved.images.cols != camera_.color.width) return;
  images_.add(saved.images);
  frame_of_image_.push_back(saved.frame);
}

std::vector<PosedImage> DenseRecorder::views(const FrameLog& log, const Map& map) const {
  const uint32_t component = main_component(log, map);
  std::unordered_map<FrameId, SE3> pose_of;
  for (const LoggedFrame& entry : log) {
    if (tracked_in(component, entry, map)) pose_of.emplace(entry.frame, world_pose(entry, map));
  }
  std::vector<PosedImage> views;
  for (size_t i = 0; i < frame_of_image_.size(); ++i) {
    const auto pose = pose_of.find(frame_of_image_[i]);
    if (pose != pose_of.end()) views.push_back({i, pose->second});
  }
  return views;
}

ColoredCloud DenseRecorder::fuse(const FrameLog& log, const Map& map, int threads,
                                 const Progress& progress) const {
  return fuse_keyframes(images_, views(log, map), camera_.color, options_, threads, progress);
}

std::optional<RgbdImages> DenseRecorder::images_of(FrameId frame) const {
  const auto kept = std::find(frame_of_image_.begin(), frame_of_image_.end(), frame);
  if (kept == frame_of_image_.end()) return std::nullopt;
  return images_.load(static_cast<size_t>(kept - frame_of_image_.begin()));
}

}  // namespace kinloop
