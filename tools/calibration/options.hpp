#pragma once

#include "kinloop/geometry/lens.hpp"

namespace kinloop {

struct CalibrationOptions {
  LensModel lens_model = LensModel::kBrownConrady;
  int distortion_terms = 5;
  double outlier_factor = 3;
  double min_tilt_difference_deg = 10;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("lens_model", self.lens_model,
          "lens to estimate; in OpenCV: the default of calibrateCamera, CALIB_RATIONAL_MODEL, fisheye");
    visit("distortion_terms", self.distortion_terms,
          "number of terms of k1 k2 p1 p2 k3 to estimate: 0, 2, 4 or 5; the others are 0; the other models "
          "estimate all their terms",
          Range{0, 5});
    visit("outlier_factor", self.outlier_factor,
          "reject a view whose RMS exceeds this multiple of the median", Range{1.5, 100});
    visit("min_tilt_difference_deg", self.min_tilt_difference_deg, "tilts closer than this count as one",
          Range{0, 90});
  }
};

/// Throws UsageError, naming key, value and expectation, where a value is not allowed.
void check_options(const CalibrationOptions& options);

}  // namespace kinloop
