#include "kinloop/optimize/pose/camera_observations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kinloop/core/errors.hpp"
#include "kinloop/optimize/kernels/bundle_products.hpp"

namespace kinloop {
namespace {

constexpr size_t kSize = ObservationBlock::kSize;
constexpr size_t kMaxSums = (LinearColumns::kMaxWidth + 3) * LinearColumns::kMaxWidth * kSize;

bool is_filled(const ObservationBlock& block, size_t lane) {
  return block.inverse_sigma_px[lane] > 0;
}

}  // namespace

void set_measurement(ObservationBlock& block, size_t lane, const KeypointMeasurement& measured) {
  const bool has_depth = measured.depth_m > 0 && std::isfinite(measured.depth_m);
  const bool has_gradient = measured.inverse_depth_gradient.allFinite();
  block.pixel_x[lane] = measured.pixel.x();
  block.pixel_y[lane] = measured.pixel.y();
  block.inverse_sigma_px[lane] = 1 / measured.sigma_px;
  block.row[lane] = measured.row;
  block.depth_stamp_difference_s[lane] = measured.depth_stamp_difference_s;
  block.inverse_depth_per_m[lane] = has_depth ? 1 / measured.depth_m : 0;
  block.gradient_x[lane] = has_gradient ? measured.inverse_depth_gradient.x() : 0;
  block.gradient_y[lane] = has_gradient ? measured.inverse_depth_gradient.y() : 0;
  block.has_gradient[lane] = has_gradient ? 1 : 0;
}

void CameraObservations::set(size_t index, const Eigen::Vector3d& p_world,
                             const KeypointMeasurement& measured) {
  ObservationBlock& block = blocks_[index / kSize];
  const size_t lane = index % kSize;
  set_measurement(block, lane, measured);
  block.x[lane] = p_world.x();
  block.y[lane] = p_world.y();
  block.z[lane] = p_world.z();
  block.uses_pixel[lane] = 1;
  block.uses_depth[lane] = block.inverse_depth_per_m[lane] > 0 ? 1 : 0;
}

bool CameraObservations::classify(const BundleView& view, const Sensor& sensor) {
  bool changed = false;
  for (ObservationBlock& block : blocks_) {
    const BlockResiduals r = block_residuals(block, view, sensor);
    for (size_t lane = 0; lane < kSize; ++lane) {
      const bool agrees = is_filled(block, lane) && r.is_pixel_inlier(lane, sensor.noise.inlier_chi2_pixel);
      const bool is_depth_inlier = agrees && block.inverse_depth_per_m[lane] > 0 &&
                                   r.is_depth_inlier(lane, sensor.noise.inlier_chi2_depth);
      const double uses_pixel = agrees ? 1 : 0, uses_depth = is_depth_inlier ? 1 : 0;
      changed = changed || uses_pixel != block.uses_pixel[lane] || uses_depth != block.uses_depth[lane];
      block.uses_pixel[lane] = uses_pixel;
      block.uses_depth[lane] = uses_depth;
    }
  }
  return changed;
}

std::vector<uint8_t> CameraObservations::inliers() const {
  std::vector<uint8_t> inliers(count_);
  for (size_t i = 0; i < count_; ++i) inliers[i] = blocks_[i / kSize].uses_pixel[i % kSize] > 0 ? 1 : 0;
  return inliers;
}

int CameraObservations::inlier_count() const {
  int count = 0;
  for (const ObservationBlock& block : blocks_) {
    count += static_cast<int>(std::count(block.uses_pixel.begin(), block.uses_pixel.end(), 1.0));
  }
  return count;
}

void ResidualSquares::add(const ObservationBlock& block, const BlockResiduals& residuals) {
  for (size_t lane = 0; lane < kSize; ++lane) {
    if (!(block.uses_pixel[lane] > 0) || !(residuals.seen[lane] > 0)) continue;
    const double u = residuals.u[lane], v = residuals.v[lane];
    sum += u * u + v * v;
    count += 2;
    if (!(block.uses_depth[lane] > 0)) continue;
    sum += residuals.depth[lane] * residuals.depth[lane];
    count += 1;
  }
}

ResidualSquares CameraObservations::residual_squares(const BundleView& view, const Sensor& sensor) const {
  ResidualSquares squares;
  for (const ObservationBlock& block : blocks_) squares.add(block, block_residuals(block, view, sensor));
  return squares;
}

CameraObservations::Normal CameraObservations::linearize(const BundleView& view, const Sensor& sensor,
                                                         const LinearColumns& layout) const {
  const GramColumns summed(layout);
  std::array<double, kRowsPerObservation * LinearColumns::kMaxWidth * kSize> columns{};
  std::array<double, kMaxSums> sums;
  require(summed.sums() <= sums.size(), "CameraObservations: too many columns");
  std::fill_n(sums.begin(), summed.sums(), 0);
  Normal normal;
  for (const ObservationBlock& block : blocks_) {
    const auto costs = linearize_block(block, view, sensor, layout, columns.data());
    add_block_gram(summed, columns.data(), sums.data());
    for (const double cost : costs) normal.cost += cost;
  }
  normal.gram = gram_of_sums(summed, {sums.data(), summed.sums()});
  return normal;
}

void CameraObservations::classify_guess(const BundleView& view, const Sensor& sensor, int min_inliers) {
  const CameraObservations all = *this;
  classify(view, sensor);
  if (inlier_count() < min_inliers) *this = all;
}

PoseNormal<6> CameraObservations::linearize_pose(const BundleView& view, const Sensor& sensor) const {
  static const LinearColumns kColumns = LinearColumns::of_pose();
  const Normal observed = linearize(view, sensor, kColumns);
  PoseNormal<6> normal;
  normal.H = observed.gram.topLeftCorner<6, 6>().selfadjointView<Eigen::Upper>();
  normal.g = observed.gram.col(LinearColumns::kResidual).head<6>();
  normal.cost = observed.cost;
  return normal;
}

PoseNormal<6> with_prior(PoseNormal<6> normal, const PosePrior& prior, const SE3& T_reference_camera) {
  const Vector6d off = (prior.T_reference_camera.inverse() * T_reference_camera).log();
  normal.H += prior.information;
  normal.g += prior.information * off;
  normal.cost += off.dot(prior.information * off);
  return normal;
}

CameraObservations observations_of(std::span<const PoseObservation> observations) {
  CameraObservations result(observations.size());
  for (size_t i = 0; i < observations.size(); ++i) {
    const PoseObservation& o = observations[i];
    if (!o.p_reference.allFinite() || !o.pixel.allFinite() || !(o.sigma_px > 0)) continue;
    result.set(i, o.p_reference, o);
  }
  return result;
}

}  // namespace kinloop
