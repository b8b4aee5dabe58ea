#pragma once

#include <set>
#include <vector>

#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns the number of components that have keyframes.
inline size_t components_of(const std::vector<Keyframe>& keyframes) {
  std::set<uint32_t> components;
  for (const Keyframe& keyframe : keyframes) components.insert(keyframe.component);
  return components.size();
}

}  // namespace kinloop
