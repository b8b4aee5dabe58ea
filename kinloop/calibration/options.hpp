#pragma once

#include "kinloop/base/options.hpp"

namespace kinloop {

struct CalibrationOptions {
  int distortion_terms = 5;
  double outlier_factor = 3;
  double alike_deg = 10;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("distortion_terms", self.distortion_terms,
          "how many of k1 k2 p1 p2 k3 are estimated: 0, 2, 4 or 5; the others are 0", Range{0, 5});
    visit("outlier_factor", self.outlier_factor,
          "a view whose RMS is so many times the median of all is left out", Range{1.5, 100});
    visit("alike_deg", self.alike_deg, "boards tilted by less against each other count as one tilt",
          Range{0, 90});
  }
};

}  // namespace kinloop
