#include "tools/calibration/options.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

void check_options(const CalibrationOptions& options) {
  validate(options);
  if (options.distortion_terms != 1 && options.distortion_terms != 3) return;
  throw UsageError(fmt::format("distortion_terms: {} is not one of 0, 2 (k1 k2), 4 (+ p1 p2), 5 (+ k3)",
                               options.distortion_terms));
}

}  // namespace kinloop
