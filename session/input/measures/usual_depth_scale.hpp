#pragma once
// Units of depth that are in use.

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace kinloop {

/// Returns the usual number of units per metre that differs from `measured` by less than the factor
/// `tolerance` and is not the `stated` one, else "about" what was measured.
inline std::string depth_scale_text(double measured, double stated, double tolerance) {
  for (const double usual : {1000.0, 5000.0, 10000.0, 4000.0, 2000.0}) {
    const double ratio = measured / usual;
    if (usual != stated && std::max(ratio, 1 / ratio) < tolerance) return fmt::format("{:g}", usual);
  }
  return fmt::format("about {:.0f}", measured);
}

}  // namespace kinloop
