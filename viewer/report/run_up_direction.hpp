#pragma once
// The up direction of a finished run.

#include <nlohmann/json.hpp>

#include "dense/up_direction.hpp"

namespace kinloop {

/// Returns direction, source and confidence as in run.json.
nlohmann::json to_json(const UpEstimate& up);

/// Returns the unit direction stored in `metrics` (a run.json); if there is none, as with another program's
/// trajectory, the mean of the cameras' up axes.
Eigen::Vector3d read_up_direction(const nlohmann::json& metrics, const Trajectory& trajectory);

}  // namespace kinloop
