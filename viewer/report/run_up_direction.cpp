#include "viewer/report/run_up_direction.hpp"

#include <algorithm>

namespace kinloop {

nlohmann::json to_json(const UpEstimate& up) {
  return {{"direction", {up.direction.x(), up.direction.y(), up.direction.z()}},
          {"source", to_string(up.source)},
          {"confidence", up.confidence}};
}

Eigen::Vector3d read_up_direction(const nlohmann::json& metrics, const Trajectory& trajectory) {
  const nlohmann::json::json_pointer place("/up/direction");
  if (metrics.is_object() && metrics.contains(place)) {
    const nlohmann::json& values = metrics[place];
    const bool numbers =
        values.is_array() && values.size() == 3 &&
        std::all_of(values.begin(), values.end(), [](const auto& v) { return v.is_number(); });
    if (numbers) {
      const Eigen::Vector3d up(values[0].get<double>(), values[1].get<double>(), values[2].get<double>());
      if (up.norm() > 0) return up.normalized();
    }
  }
  return mean_camera_up(camera_poses(trajectory)).direction;
}

}  // namespace kinloop
