#pragma once
// Observations of given points by one camera, shared by the single-pose solvers.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/optimize/kernels/observation_block.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"
#include "kinloop/optimize/pose/pose_minimizer.hpp"
#include "kinloop/sensor/keypoint_measurement.hpp"

namespace kinloop {

/// Writes a measurement (without point and use flags) to a lane of a block.
void set_measurement(ObservationBlock& block, size_t lane, const KeypointMeasurement& measured);

/// The squared residuals of pixels and depths in use, without robust weights.
struct ResidualSquares {
  double sum = 0;    ///< in variances of the assumed noise
  double count = 0;  ///< residuals: two a pixel, one a depth

  void add(const ObservationBlock& block, const BlockResiduals& residuals);

  /// Returns the variance of the noise, in that of the assumed noise, after an estimate of `unknowns` values;
  /// 0 if these are as many as the residuals.
  [[nodiscard]] double variance(double unknowns) const {
    return count > unknowns ? sum / (count - unknowns) : 0;
  }
};

/// Observations of one camera with their use flags.
class CameraObservations {
 public:
  explicit CameraObservations(size_t count) : count_(count), blocks_(block_count(count)) {}

  static constexpr size_t block_count(size_t observations) {
    return (observations + ObservationBlock::kSize - 1) / ObservationBlock::kSize;
  }

  /// Enables all measured parts. Lanes without an observation stay unused.
  void set(size_t index, const Eigen::Vector3d& p_world, const KeypointMeasurement& measured);

  /// Classifies inliers and outliers, pixel and depth separately; true if anything changed.
  bool classify(const BundleView& view, const Sensor& sensor);

  /// Drops the outliers of a guess if at least `min_inliers` are left: with a good guess they are known from
  /// the start.
  void classify_guess(const BundleView& view, const Sensor& sensor, int min_inliers);

  [[nodiscard]] std::vector<uint8_t> inliers() const;  ///< 1 = in use
  [[nodiscard]] int inlier_count() const;

  [[nodiscard]] ResidualSquares residual_squares(const BundleView& view, const Sensor& sensor) const;

  /// J'J over all rows (upper triangle only) and the robust cost.
  struct Normal {
    Eigen::MatrixXd gram;
    double cost = 0;
  };
  [[nodiscard]] Normal linearize(const BundleView& view, const Sensor& sensor,
                                 const LinearColumns& layout) const;

  /// The normal equations of the pose alone.
  [[nodiscard]] PoseNormal<6> linearize_pose(const BundleView& view, const Sensor& sensor) const;

 private:
  size_t count_;
  std::vector<ObservationBlock> blocks_;
};

/// Returns the observations of a camera. Those with values that are not finite stay unused.
CameraObservations observations_of(std::span<const PoseObservation> observations);

/// Adds the prior of a pose to its normal equations at `T_reference_camera`.
PoseNormal<6> with_prior(PoseNormal<6> normal, const PosePrior& prior, const SE3& T_reference_camera);

}  // namespace kinloop
