#pragma once
// In: what was measured of detectors with several seeds. Out: the figures for people and for scripts, each
// with its range over the seeds.

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/features/feature_comparison.hpp"

namespace kinloop {

/// A row of medians for each detector, and below it the lowest and the highest figure of a seed.
std::string comparison_table(const std::vector<DetectorMetrics>& figures);

/// The medians, and as "ranges" the lowest and the highest figure of a seed.
nlohmann::json comparison_json(const std::vector<DetectorMetrics>& figures);

}  // namespace kinloop
