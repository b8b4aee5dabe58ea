#include "dense/live_mesh/view_gain.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "dense/cloud/color_gains.hpp"
#include "kinloop/core/quantile.hpp"

namespace kinloop {

std::optional<ColorGain> view_gain(const std::vector<ColorPair>& pairs) {
  constexpr size_t kFewest = 50;
  constexpr float kMost = 3;
  std::array<std::vector<float>, 3> ratios;
  for (const auto& [view, mesh] : pairs) {
    if (!is_well_exposed(view) || !is_well_exposed(mesh)) continue;
    for (size_t i = 0; i < 3; ++i)
      ratios[i].push_back(static_cast<float>(mesh[i]) / static_cast<float>(view[i]));
  }
  if (ratios[0].size() < kFewest) return std::nullopt;
  ColorGain gain;
  for (size_t i = 0; i < 3; ++i)
    gain[static_cast<Eigen::Index>(i)] = std::clamp(median(std::move(ratios[i])), 1 / kMost, kMost);
  return gain;
}

}  // namespace kinloop
