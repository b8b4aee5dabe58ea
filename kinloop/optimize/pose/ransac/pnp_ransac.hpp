#pragma once
// Estimates a camera pose from 3D points of a reference frame and their pixels, many of them wrong, without
// an initial pose.

#include "kinloop/optimize/pose/absolute_pose.hpp"

namespace kinloop {

struct PnpRansacOptions {
  int max_iterations = 1000;
  double confidence = 0.999;
  int min_inliers = 12;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_iterations", self.max_iterations, "maximum number of RANSAC iterations", Range{1, 100000});
    visit("confidence", self.confidence, "probability that at least one sample is free of outliers",
          Range{0.5, 0.999999});
    visit("min_inliers", self.min_inliers, "minimum number of inliers", Range{4, 1000});
  }
};

/// Returns the pose with the most inliers: P3P (Gao 2003 in the form of Ke and Roumeliotis 2017) inside
/// RANSAC, with each new best refined on its inliers (Chum 2003) by solve_absolute_pose with
/// `pose_options`. Deterministic for a given seed.
std::optional<AbsolutePoseSolution> solve_pnp_ransac(const Sensor& sensor,
                                                     std::span<const PoseObservation> observations,
                                                     const PnpRansacOptions& options,
                                                     const AbsolutePoseOptions& pose_options, uint64_t seed);

}  // namespace kinloop
