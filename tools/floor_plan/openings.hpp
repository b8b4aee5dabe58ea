#pragma once
// In: the walls of rooms and the space seen free beyond them. Out: their openings.

#include <span>
#include <vector>

#include "tools/floor_plan/floor_plan.hpp"

namespace kinloop {

/// Heights of the sight through a doorway, above the floor, near it and above most sills.
constexpr HeightRange kLowSight{0.15, 0.6}, kHighSight{0.9, 1.8};

struct OpeningEvidence {
  const cv::Mat& low_free;   ///< 8UC1, 255 = seen free within kLowSight
  const cv::Mat& high_free;  ///< same, within kHighSight
  const PlanGrid& grid;
};

/// Adds the openings of all walls.
void find_openings(std::vector<PlanRoom>& rooms, const OpeningEvidence& evidence);

}  // namespace kinloop
