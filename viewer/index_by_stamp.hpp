#pragma once

#include <cstdint>
#include <unordered_map>

namespace kinloop {

/// Returns the index of each element by its stamp, ns; of the first where stamps repeat.
template <class Stamped>
std::unordered_map<int64_t, uint32_t> index_by_stamp(const Stamped& elements) {
  std::unordered_map<int64_t, uint32_t> index_of;
  for (uint32_t i = 0; i < elements.size(); ++i) index_of.emplace(elements[i].stamp_ns, i);
  return index_of;
}

}  // namespace kinloop
