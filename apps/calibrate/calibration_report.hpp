#pragma once
// In: calibration results. Out: figures as JSON, text for the terminal, and one self-contained HTML page.

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/calibration/depth_shift.hpp"
#include "tools/calibration/lens.hpp"
#include "tools/calibration/rig.hpp"

namespace kinloop {

/// Returns parameters with standard deviations, errors per view, rejected views, warnings.
nlohmann::json to_json(const LensCalibration& calibration);
nlohmann::json to_json(const RigCalibration& calibration);
nlohmann::json to_json(const DepthShift& shift);

/// Same for the terminal.
std::string to_text(const LensCalibration& calibration);
std::string to_text(const RigCalibration& calibration);
std::string to_text(const DepthShift& shift);

/// Returns a section of the page: a table of the parameters, plots of the errors and the coverage, the views.
std::string lens_section(const std::string& title, const LensCalibration& calibration);
std::string rig_section(const RigCalibration& calibration);
std::string depth_section(const DepthShift& shift);

/// Returns the page with these sections.
std::string calibration_page(const std::string& title, const std::string& subtitle,
                             const std::string& sections);

}  // namespace kinloop
