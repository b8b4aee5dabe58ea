#include "session/work_budget.hpp"

#include <algorithm>

namespace kinloop {

const std::vector<WorkLevel>& work_levels() {
  static const std::vector<WorkLevel> levels{
      {25, {}},
      {20, {"dense.surfels_at_end=true"}},
      {17, {"dense.surfels_at_end=true", "features.count=800", "local_map.max_landmarks=1000"}},
      {14,
       {"dense.surfels_at_end=true", "features.count=700", "local_map.max_landmarks=700",
        "mapping.triangulation_keyframes=0"}}};
  return levels;
}

const WorkLevel& work_level(double percent) {
  const auto& levels = work_levels();
  const auto affordable = std::find_if(levels.begin(), levels.end(),
                                       [=](const WorkLevel& level) { return level.percent <= percent; });
  return affordable != levels.end() ? *affordable : levels.back();
}

}  // namespace kinloop
