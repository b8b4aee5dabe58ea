#include "kinloop/back_end/withdraw_keyframes.hpp"

#include <vector>

namespace kinloop {
namespace {

/// Expresses a pose relative to another keyframe. Its place in the world stays.
void express_in(KeyframeId reference, const Map& map, TrackedFrame& entry) {
  entry.T_reference_camera = map.keyframe(reference).T_world_camera.inverse() * world_pose(entry, map);
  entry.reference = reference;
}

}  // namespace

std::optional<KeyframeId> withdraw_keyframes(size_t begin, uint32_t component, Map& map, FrameLog& log) {
  const auto is_before = [first = log[begin].id](const Keyframe& keyframe) {
    return keyframe.frame.value < first.value;
  };
  KeyframeId last;
  std::vector<KeyframeId> wrong;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.component != component) continue;
    if (is_before(keyframe)) {
      last = keyframe.id;
    } else {
      wrong.push_back(keyframe.id);
    }
  }
  if (wrong.empty() || !last.valid()) return std::nullopt;
  for (size_t i = begin; i < log.size(); ++i) {
    TrackedFrame& entry = log[i];
    if (!is_tracked_in(component, entry, map)) continue;
    entry.doubtful = true;
    entry.keyframe = {};
    if (!is_before(map.keyframe(entry.reference))) express_in(last, map, entry);
  }
  for (const KeyframeId id : wrong) map.withdraw(id);
  return last;
}

}  // namespace kinloop
