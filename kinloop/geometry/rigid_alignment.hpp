#pragma once
// The rigid motion that best maps one point set onto another.

#include <optional>
#include <span>

#include <Eigen/Core>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// T_a_b minimising sum w_i |a_i - T_a_b b_i|^2 (Horn 1987, by SVD as in Umeyama 1991, no scale). `weights`
/// may be empty (all 1). Nothing when fewer than three pairs are given or they do not fix the rotation.
std::optional<SE3> align_rigid(std::span<const Eigen::Vector3d> points_a,
                               std::span<const Eigen::Vector3d> points_b,
                               std::span<const double> weights = {});

}  // namespace kinloop
