#include "kinloop/eval/run_up.hpp"

#include <algorithm>

namespace kinloop {

nlohmann::json to_json(const UpEstimate& up) {
  return {{"direction", {up.direction.x(), up.direction.y(), up.direction.z()}},
          {"source", name_of(up.source)},
          {"confidence", up.confidence}};
}

Eigen::Vector3d up_of_run(const nlohmann::json& figures, const Trajectory& trajectory) {
  const nlohmann::json::json_pointer place("/up/direction");
  if (figures.is_object() && figures.contains(place)) {
    const nlohmann::json& values = figures[place];
    const bool numbers =
        values.is_array() && values.size() == 3 &&
        std::all_of(values.begin(), values.end(), [](const auto& v) { return v.is_number(); });
    if (numbers) {
      const Eigen::Vector3d up(values[0].get<double>(), values[1].get<double>(), values[2].get<double>());
      if (up.norm() > 0) return up.normalized();
    }
  }
  return up_of_cameras(poses_of(trajectory)).direction;
}

}  // namespace kinloop
