#pragma once
// Estimates a camera pose from 3D points of a reference frame and their pixels (optionally with depth), given
// an initial pose. Also returns the inliers and the information matrix.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/keypoint_measurement.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Measurement of a point given in the reference frame.
struct PoseObservation : KeypointMeasurement {
  Eigen::Vector3d p_reference = Eigen::Vector3d::Zero();  ///< m
};

struct AbsolutePoseOptions {
  int rounds = 4;
  int max_iterations = 8;
  int min_inliers = 6;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("rounds", self.rounds, "rounds of outlier reclassification", Range{1, 20});
    visit("max_iterations", self.max_iterations, "maximum Gauss-Newton iterations per round", Range{1, 100});
    visit("min_inliers", self.min_inliers, "minimum number of inliers", Range{3, 1000});
  }
};

/// What is known of a pose from elsewhere, such as planes or the motion before it.
struct PosePrior {
  SE3 T_reference_camera;
  Matrix6d information = Matrix6d::Zero();  ///< of T * exp(x), x = (translation; rotation)
};

/// A camera pose with its inliers.
struct AbsolutePoseSolution {
  SE3 T_reference_camera;
  std::vector<uint8_t> inliers;  ///< 1 = inlier
  int inlier_count = 0;
  Matrix6d information = Matrix6d::Zero();  ///< of T * exp(x), x = (translation; rotation)
  double chi2 = 0;                          ///< sum of squared normalised residuals of the inliers
};

/// Returns the pose near `T_reference_camera_guess` that minimizes the robust cost (Gauss-Newton). nullopt if
/// there are fewer than `min_inliers` inliers or they leave a direction of the pose unconstrained.
/// Observations with values that are not finite are outliers. Pixel and depth have separate robust losses: a
/// keypoint at a depth edge has a good pixel but may have the depth of the wrong side. The observations are
/// motion-compensated: the corrections of the sensor are in them already. A prior is part of the cost, and of
/// the information of the solution, but not of its chi2.
std::optional<AbsolutePoseSolution> solve_absolute_pose(const Sensor& sensor,
                                                        std::span<const PoseObservation> observations,
                                                        const SE3& T_reference_camera_guess,
                                                        const AbsolutePoseOptions& options,
                                                        const std::optional<PosePrior>& prior = {});

/// Returns 1 for each observation whose pixel is an inlier at the pose; depth is ignored.
std::vector<uint8_t> pixel_inliers(const Sensor& sensor, std::span<const PoseObservation> observations,
                                   const SE3& T_reference_camera);

}  // namespace kinloop
