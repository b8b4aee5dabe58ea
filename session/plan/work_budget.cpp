#include "session/plan/work_budget.hpp"

#include <algorithm>

namespace kinloop {

const std::vector<WorkLevel>& work_levels() {
  static const std::vector<WorkLevel> levels{
      {24, {}},
      {20, {"dense.surfels_at_end=true"}},
      {18, {"dense.surfels_at_end=true", "features.count=800", "local_map.max_landmarks=2000"}},
      {15,
       {"dense.surfels_at_end=true", "features.count=600", "local_map.max_landmarks=1200",
        "tracking.keyframe.max_relative_translation=0.11", "tracking.keyframe.max_rotation_rad=0.27",
        "mapping.triangulation_keyframes=2", "mapping.local_ba_keyframes=8"}}};
  return levels;
}

const WorkLevel& work_level(double percent) {
  const auto& levels = work_levels();
  const auto affordable = std::find_if(levels.begin(), levels.end(),
                                       [=](const WorkLevel& level) { return level.percent <= percent; });
  return affordable != levels.end() ? *affordable : levels.back();
}

}  // namespace kinloop
