#pragma once
// Which way is up in the world of a run that is over.

#include <nlohmann/json.hpp>

#include "kinloop/geometry/up_direction.hpp"

namespace kinloop {

/// As run.json has it: direction, source and confidence.
nlohmann::json to_json(const UpEstimate& up);

/// The unit direction that `metrics` (a run.json) has; where it has none, as that of another program's
/// trajectory, the mean of the cameras' own up axes.
Eigen::Vector3d read_up_direction(const nlohmann::json& metrics, const Trajectory& trajectory);

}  // namespace kinloop
