#pragma once
// Rigid alignment of two point sets.

#include <optional>
#include <span>

#include <Eigen/Core>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Returns the T_a_b that minimises sum w_i |a_i - T_a_b b_i|^2 (Horn 1987, by SVD as in Umeyama 1991, no
/// scale). `weights` may be empty (all 1). Returns nullopt for fewer than three pairs or if they do not
/// determine the rotation.
std::optional<SE3> align_rigid(std::span<const Eigen::Vector3d> points_a,
                               std::span<const Eigen::Vector3d> points_b,
                               std::span<const double> weights = {});

}  // namespace kinloop
