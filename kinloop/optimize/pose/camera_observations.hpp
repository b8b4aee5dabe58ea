#pragma once
// Observations of given points by one camera, shared by the single-pose solvers.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "kinloop/optimize/kernels/observation_block.hpp"
#include "kinloop/sensor/keypoint_measurement.hpp"

namespace kinloop {

/// Writes a measurement (without point and use flags) to a lane of a block.
void set_measurement(ObservationBlock& block, size_t lane, const KeypointMeasurement& measured);

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

  [[nodiscard]] std::vector<uint8_t> inliers() const;  ///< 1 = in use
  [[nodiscard]] int inlier_count() const;

  /// J'J over all rows (upper triangle only) and the robust cost.
  struct Normal {
    Eigen::MatrixXd gram;
    double cost = 0;
  };
  [[nodiscard]] Normal linearize(const BundleView& view, const Sensor& sensor,
                                 const LinearColumns& layout) const;

 private:
  size_t count_;
  std::vector<ObservationBlock> blocks_;
};

}  // namespace kinloop
