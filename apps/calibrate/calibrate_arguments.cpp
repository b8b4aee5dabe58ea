#include "apps/calibrate/calibrate_arguments.hpp"

#include "kinloop/core/errors.hpp"
#include "kinloop/core/options.hpp"
#include "tools/calibration/charuco.hpp"

namespace kinloop {

Board CalibrateArguments::chosen_board() const {
  Board chosen = parse_board(board, square_m, marker_m);
  if (chosen.has_markers()) require_charuco(chosen);
  return chosen;
}

CalibrationOptions CalibrateArguments::options() const {
  const auto chosen = with_assignments(CalibrationOptions{}, assignments);
  check_options(chosen);
  return chosen;
}

std::filesystem::path CalibrateArguments::sibling_file(const char* ending) const {
  auto path = output;
  path.replace_extension();
  path += ending;
  return path;
}

}  // namespace kinloop
