#pragma once
// The size of a place as a keyframe sees it, relative to that of the map. Depth is metric, so the same place
// has the same size; its double in another room, or depth that is scaled, has not.

#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/map/loop_closure.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// A point in the frames of both sides, m.
struct ScalePair {
  Eigen::Vector3d a, b;
  double sigma_m = 0.01;  ///< of their difference (1 sigma)
};

/// Estimates s in a = s R b + t for a known rotation R_a_b: linear least squares with Huber's loss, whose
/// width follows the median residual. An unknown scale (infinite sigma) for fewer than `kMinScalePairs`
/// pairs.
RelativeScale estimate_scale(std::span<const ScalePair> pairs, const Eigen::Matrix3d& R_a_b);

inline constexpr size_t kMinScalePairs = 20;

/// Matches the landmarks of the local map with the frame near their projections whatever their depth, and
/// returns the scale of their positions relative to those that the frame has measured.
RelativeScale measure_scale(const TrackingInput& in, const SE3& T_reference_camera);

/// Returns the mean of independent measurements, weighted by their variances; unknown if all are.
RelativeScale combine(std::span<const RelativeScale> scales);

/// Returns whether a scale differs from 1 by more than its uncertainty (three sigma) and more than the limit.
bool contradicts_equal_size(const RelativeScale& scale, double max_difference);

/// Returns whether a scale differs from 1 too much for one place, by 2 %.
bool contradicts_same_place(const RelativeScale& scale);

}  // namespace kinloop
