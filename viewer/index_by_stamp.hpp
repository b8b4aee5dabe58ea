#pragma once

#include <cstdint>
#include <unordered_map>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Returns the index of each pose by its stamp, ns; of the first where stamps repeat.
inline std::unordered_map<int64_t, uint32_t> index_by_stamp(const Trajectory& poses) {
  std::unordered_map<int64_t, uint32_t> index_of;
  for (uint32_t i = 0; i < poses.size(); ++i) index_of.emplace(poses[i].stamp_ns, i);
  return index_of;
}

}  // namespace kinloop
