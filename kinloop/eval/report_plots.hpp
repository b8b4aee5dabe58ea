#pragma once
// The sections of a report that are drawn.

#include <optional>
#include <string>

#include "kinloop/eval/evaluate.hpp"
#include "kinloop/eval/report.hpp"

namespace kinloop {

/// The path from above and from the side, over ground truth where `ate` tells how they lie to each other.
std::string path_section(const RunReport& report, const std::optional<AteResult>& ate);

/// The position error over time and how it is distributed.
std::string error_section(const AteResult& ate);

}  // namespace kinloop
