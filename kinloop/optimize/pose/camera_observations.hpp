#pragma once
// What one camera sees of known points: the common part of the estimates of a single pose.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "kinloop/geometry/keypoint_measurement.hpp"
#include "kinloop/optimize/kernels/gram.hpp"
#include "kinloop/optimize/kernels/observation_block.hpp"

namespace kinloop {

struct AbsolutePoseOptions;

/// Writes a measurement (not its point and its use) to a place of a block.
void set_measurement(ObservationBlock& block, size_t lane, const KeypointMeasurement& measured);

/// Observations of one camera, and what of each is in use.
class CameraObservations {
 public:
  explicit CameraObservations(size_t count) : count_(count), blocks_(block_count(count)) {}

  static constexpr size_t block_count(size_t observations) {
    return (observations + ObservationBlock::kSize - 1) / ObservationBlock::kSize;
  }

  /// Puts all that was measured in use. Places without an observation stay out of it for good.
  void set(size_t index, const Eigen::Vector3d& p_world, const KeypointMeasurement& measured);

  /// Tells inliers from outliers; true when anything changed. Pixel and depth are judged each for itself.
  bool classify(const BundleView& view, const MeasurementModel& model, const AbsolutePoseOptions& options);

  [[nodiscard]] std::vector<uint8_t> inliers() const;  ///< 1 = in use
  [[nodiscard]] int inlier_count() const;

  /// J'J of the rows of all, of which the upper triangle counts, and the robust cost.
  struct Normal {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> gram;
    double cost = 0;
  };
  [[nodiscard]] Normal linearize(const BundleView& view, const MeasurementModel& model,
                                 const RowLayout& layout) const;

 private:
  size_t count_;
  std::vector<ObservationBlock> blocks_;
};

}  // namespace kinloop
