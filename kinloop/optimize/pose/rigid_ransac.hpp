#pragma once
// In: pairs of 3D points, one seen by camera a and one by camera b, many of them wrong. Out: the rigid motion
// between the cameras with its inliers.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/base/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/depth_noise.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// The same point as two cameras measured it, each in its own frame.
struct PointPair {
  Eigen::Vector3d p_a = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d p_b = Eigen::Vector3d::Zero();  ///< m
  double sigma_a_px = 1;                          ///< standard deviation of its pixel in camera a
  double sigma_b_px = 1;                          ///< and in camera b
};

struct RigidRansacOptions {
  int max_iterations = 300;
  double confidence = 0.999;
  int min_inliers = 12;
  double inverse_depth_sigma_per_m =
      kPointPairInverseDepthSigmaPerM;  ///< Slam sets it from SlamOptions::noise

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_iterations", self.max_iterations, "maximum number of RANSAC iterations", Range{1, 100000});
    visit("confidence", self.confidence, "probability that at least one sample is free of outliers",
          Range{0.5, 0.999999});
    visit("min_inliers", self.min_inliers, "minimum number of inliers", Range{3, 1000});
  }
};

/// A motion between two cameras with its support.
struct RigidSolution {
  SE3 T_a_b;
  std::vector<uint8_t> inliers;  ///< 1 where the pair agrees
  int inlier_count = 0;
  Matrix6d information = Matrix6d::Zero();  ///< of T_a_b * exp(x), x = (translation; rotation)
  double chi2 = 0;                          ///< sum of squared Mahalanobis distances of the inliers
};

/// The motion that most pairs agree with, by the noise of pixels and depths on both sides: Horn's alignment
/// of three pairs inside RANSAC, then Gauss-Newton on the inliers. The same seed gives the same result.
/// Nothing where fewer than `min_inliers` agree or they leave the motion open (points on a line).
std::optional<RigidSolution> solve_rigid_ransac(const PinholeCamera& camera, std::span<const PointPair> pairs,
                                                const RigidRansacOptions& options, uint64_t seed);

/// The motion near `T_a_b_guess` that agrees best with the pairs, without sampling.
std::optional<RigidSolution> refine_rigid(const PinholeCamera& camera, std::span<const PointPair> pairs,
                                          const SE3& T_a_b_guess, const RigidRansacOptions& options);

}  // namespace kinloop
