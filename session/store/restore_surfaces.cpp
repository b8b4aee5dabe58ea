#include "session/store/restore_surfaces.hpp"

#include <memory>
#include <unordered_map>

#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

void restore_surfaces(SavedMap& saved, const MapReader& reader) {
  const auto camera = make_surface_camera(make_sensor(saved.camera));
  const ImageEncoding stored{.depth_scale = saved.camera.depth_scale};
  std::unordered_map<FrameId, Keyframe*> keyframe_of;
  for (Keyframe& keyframe : saved.map.keyframes) keyframe_of.emplace(keyframe.frame, &keyframe);
  reader.read_images([&](const SavedImages& images) {
    const auto keyframe = keyframe_of.find(images.frame);
    if (keyframe == keyframe_of.end()) return;
    const cv::Mat depth_m = decode_images(images.images, stored).depth_m;
    keyframe->second->surfaces = std::make_shared<const SurfaceGrid>(make_surface_grid(camera, depth_m));
  });
}

}  // namespace kinloop
