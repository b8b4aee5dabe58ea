#pragma once
// Loops as run.json lists them.

#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns a list of objects: the stamps of both keyframes, inliers, the keyframes that agree (`support`),
/// the relative scale (null if unknown), `status` and `reason`.
nlohmann::json loops_json(const std::vector<LoopClosure>& loops, const Map& map);

}  // namespace kinloop
