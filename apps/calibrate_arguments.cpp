#include "apps/calibrate_arguments.hpp"

#include "kinloop/base/errors.hpp"
#include "kinloop/base/options.hpp"
#include "kinloop/calibration/charuco.hpp"

namespace kinloop {

Board CalibrateArguments::chosen_board() const {
  Board chosen = parse_board(board, square_m, marker_m);
  if (chosen.has_markers()) require_charuco(chosen);
  return chosen;
}

CalibrationOptions CalibrateArguments::options() const {
  const auto chosen = with_assignments(CalibrationOptions{}, assignments);
  if (chosen.distortion_terms == 1 || chosen.distortion_terms == 3) {
    throw UsageError("distortion_terms: k1 and k2 go together, and p1 and p2; 0, 2, 4 or 5");
  }
  return chosen;
}

std::filesystem::path CalibrateArguments::beside(const char* ending) const {
  auto path = output;
  path.replace_extension();
  path += ending;
  return path;
}

}  // namespace kinloop
