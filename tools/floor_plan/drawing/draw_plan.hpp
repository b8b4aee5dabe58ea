#pragma once
// In: a floor plan. Out: a drawing of it at a usual scale, or its numbers as JSON.

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/floor_plan/drawing/drawing.hpp"
#include "tools/floor_plan/floor_plan.hpp"

namespace kinloop {

/// Draws the plan on A4, upright or across, turned so that the longest wall is parallel to an edge.
Drawing draw_plan(const FloorPlan& plan, const std::string& title);

/// Returns floor, ceiling, rooms, walls and openings; lengths in metres, positions in the frame of the plan.
nlohmann::json to_json(const FloorPlan& plan);

}  // namespace kinloop
