#pragma once
// In: results of calibration. Out: figures as JSON, text for the terminal, and one HTML page that needs
// nothing else.

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/calibration/depth_shift.hpp"
#include "tools/calibration/lens.hpp"
#include "tools/calibration/rig.hpp"

namespace kinloop {

/// Parameters with their standard deviations, errors per view, what was left out, warnings.
nlohmann::json to_json(const LensCalibration& calibration);
nlohmann::json to_json(const RigCalibration& calibration);
nlohmann::json to_json(const DepthShift& shift);

/// The same for people.
std::string to_text(const LensCalibration& calibration);
std::string to_text(const RigCalibration& calibration);
std::string to_text(const DepthShift& shift);

/// Sections of the page: a table of the parameters, the errors, where the corners lay, the views.
std::string lens_section(const std::string& title, const LensCalibration& calibration);
std::string rig_section(const RigCalibration& calibration);
std::string depth_section(const DepthShift& shift);

/// The page of these sections.
std::string calibration_page(const std::string& title, const std::string& subtitle,
                             const std::string& sections);

}  // namespace kinloop
