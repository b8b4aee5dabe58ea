#pragma once
// Estimates the rigid motion between two cameras from pairs of 3D points, many of them wrong.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// A point measured by two cameras, each in its own frame.
struct PointPair {
  Eigen::Vector3d p_a = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d p_b = Eigen::Vector3d::Zero();  ///< m
  double sigma_a_px = 1;                          ///< standard deviation of the pixel in camera a
  double sigma_b_px = 1;                          ///< standard deviation of the pixel in camera b
};

struct RigidRansacOptions {
  int max_iterations = 300;
  double confidence = 0.999;
  int min_inliers = 12;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_iterations", self.max_iterations, "maximum number of RANSAC iterations", Range{1, 100000});
    visit("confidence", self.confidence, "probability that at least one sample is free of outliers",
          Range{0.5, 0.999999});
    visit("min_inliers", self.min_inliers, "minimum number of inliers", Range{3, 1000});
  }
};

/// The motion between two cameras with its inliers.
struct RigidSolution {
  SE3 T_a_b;
  std::vector<uint8_t> inliers;  ///< 1 = inlier
  int inlier_count = 0;
  Matrix6d information = Matrix6d::Zero();  ///< of T_a_b * exp(x), x = (translation; rotation)
  double chi2 = 0;                          ///< sum of squared Mahalanobis distances of the inliers
};

/// Returns the motion with the most inliers, given the pixel and depth noise of both cameras: Horn's
/// alignment of three pairs inside RANSAC, then Gauss-Newton on the inliers. Deterministic for a given seed.
/// nullopt if there are fewer than `min_inliers` inliers or the motion is unconstrained (points on a line).
std::optional<RigidSolution> solve_rigid_ransac(const Sensor& sensor, std::span<const PointPair> pairs,
                                                const RigidRansacOptions& options, uint64_t seed);

/// Returns the motion near `T_a_b_guess` that fits the pairs best, without sampling.
std::optional<RigidSolution> refine_rigid(const Sensor& sensor, std::span<const PointPair> pairs,
                                          const SE3& T_a_b_guess, const RigidRansacOptions& options);

}  // namespace kinloop
