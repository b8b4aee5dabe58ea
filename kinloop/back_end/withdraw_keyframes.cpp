#include "kinloop/back_end/withdraw_keyframes.hpp"

#include <vector>

namespace kinloop {

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
    LoggedFrame& entry = log[i];
    if (!is_tracked_in(component, entry, map)) continue;
    doubt(entry, DoubtCause::kWithdrawn);
    entry.keyframe = {};
    KeyframePose& pose = entry;
    if (!is_before(map.keyframe(pose.reference))) pose = pose.in(last, map);
  }
  for (const KeyframeId id : wrong) map.withdraw(id);
  return last;
}

}  // namespace kinloop
