#pragma once
// In: an adjusted map. Out: how strong the noise of depth was, relative to its model.

#include <optional>

#include "kinloop/slam/slam.hpp"

namespace kinloop {

/// Returns the robust standard deviation of the residuals of depth in units of the noise at keypoints,
/// at the poses, points, velocities and sensor of `problem`: 1 if the model is right. Only
/// observations whose pixel is an inlier count, whatever their depth. nullopt if they are too few.
///
/// It is the median of the absolute differences of two residuals of one point / (0.6745 sqrt(2)) (Shamos
/// 1976, "Geometry and statistics: problems at the interface"). The residuals themselves are too small: a
/// robust fit puts many points exactly at one of their depths. A point's error cancels in the differences.
std::optional<double> depth_noise_scale(const BundleProblem& problem);

/// Same for the keypoints of all keyframes of a run that has finished.
std::optional<double> depth_noise_scale(const Slam& slam);

}  // namespace kinloop
