#pragma once
// In: measurements of detectors with several seeds. Out: the figures as text and JSON, each with its range
// over the seeds.

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/features/feature_comparison.hpp"

namespace kinloop {

/// Returns a row of medians per detector, and below it the lowest and highest figure over the seeds.
std::string comparison_table(const std::vector<DetectorMetrics>& figures);

/// Returns the medians, and as "ranges" the lowest and highest figure over the seeds.
nlohmann::json comparison_json(const std::vector<DetectorMetrics>& figures);

}  // namespace kinloop
