#pragma once
// In: the colours of surfaces in a view, and those that the mesh has there. Out: factors that make up for
// the exposure and white balance of the view. dense/cloud/color_gains solves for all views together instead.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dense/cloud/colored_cloud.hpp"

namespace kinloop {

/// Factors for red, green and blue.
using ColorGain = Eigen::Array3f;

/// The colour of one surface in a view and in the mesh.
struct ColorPair {
  Rgb view{}, mesh{};
};

/// Returns the factors that take colours of the view to those of the mesh, each the median over the pairs;
/// nullopt if too few are well exposed. At most 3, at least 1/3: more is not the exposure.
std::optional<ColorGain> view_gain(const std::vector<ColorPair>& pairs);

}  // namespace kinloop
