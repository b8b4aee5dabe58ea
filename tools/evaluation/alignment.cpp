#include "tools/evaluation/alignment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

std::vector<double> seconds_of(const Trajectory& trajectory) {
  std::vector<double> stamps_s;
  for (const StampedPose& pose : trajectory) stamps_s.push_back(rounded_seconds(pose.stamp_ns));
  return stamps_s;
}

/// For each stamp of the shorter list the closest of the longer one, the earlier on ties; some may serve
/// twice. `found(i, j)` is called for indices into the shorter and the longer list.
template <class Found>
void for_each_closest(const std::vector<double>& shorter_s, const std::vector<double>& longer_s,
                      double max_difference_s, const Found& found) {
  for (size_t i = 0; i < shorter_s.size(); ++i) {
    const auto after = std::upper_bound(longer_s.begin(), longer_s.end(), shorter_s[i]);
    const auto next = std::min(static_cast<size_t>(after - longer_s.begin()), longer_s.size() - 1);
    const double to_next_s = longer_s[next] - shorter_s[i];
    if (next > 0 && shorter_s[i] - longer_s[next - 1] <= to_next_s) {
      if (shorter_s[i] - longer_s[next - 1] <= max_difference_s) found(i, next - 1);
    } else if (std::abs(to_next_s) <= max_difference_s) {
      found(i, next);
    }
  }
}

/// First and second moments of matched centres and orientations.
struct Moments {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_b = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();   ///< of the centres, a b'
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Zero();  ///< mean of R_a_camera R_b_camera'
  double variance_b = 0;
};

Moments moments_of(std::span<const SE3> a, std::span<const SE3> b) {
  Moments m;
  const auto n = static_cast<double>(a.size());
  for (size_t i = 0; i < a.size(); ++i) {
    m.mean_a += a[i].translation / n;
    m.mean_b += b[i].translation / n;
  }
  for (size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d from_b = b[i].translation - m.mean_b;
    m.covariance += (a[i].translation - m.mean_a) * from_b.transpose() / n;
    m.orientation += a[i].R() * b[i].R().transpose() / n;
    m.variance_b += from_b.squaredNorm() / n;
  }
  return m;
}

using Svd = Eigen::JacobiSVD<Eigen::Matrix3d>;

Svd decompose(const Eigen::Matrix3d& matrix) {
  return Svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
}

/// The last sign of Umeyama's S, which makes a rotation of the two factors.
double last_sign(const Svd& svd) {
  return (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
}

Eigen::Matrix3d rotation_of(const Svd& svd) {
  return svd.matrixU() * Eigen::Vector3d(1, 1, last_sign(svd)).asDiagonal() * svd.matrixV().transpose();
}

/// The rotation that aligns the centres; if they leave it free, that which aligns the orientations, too.
Eigen::Matrix3d aligning_rotation(const Moments& m, const Svd& svd) {
  constexpr double kRankTolerance = 1e-12;
  const auto& singular = svd.singularValues();
  if (singular(1) > kRankTolerance * singular(0)) return rotation_of(svd);
  // Orientations decide where the centres do not, with a weight that does not tilt the line.
  constexpr double kOrientationWeight = 1e-9;
  const double extent = singular(0) > 0 ? singular(0) : 1;
  return rotation_of(decompose(m.covariance + kOrientationWeight * extent * m.orientation));
}

/// The angle about z that maximises the sum of a_i' R_z b_i.
Eigen::Matrix3d aligning_yaw(const Moments& m) {
  const Eigen::Matrix3d& c = m.covariance.topLeftCorner<2, 2>().isZero(0) ? m.orientation : m.covariance;
  const double angle_rad = std::atan2(c(1, 0) - c(0, 1), c(0, 0) + c(1, 1));
  return Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

double rounded_seconds(int64_t stamp_ns) {
  const int64_t whole_s = stamp_ns / kNsPerSecond;
  const auto fraction = static_cast<double>(stamp_ns % kNsPerSecond) / static_cast<double>(kNsPerSecond);
  return static_cast<double>(whole_s) + fraction;
}

std::vector<StampPair> pair_poses(const Trajectory& estimate, const Trajectory& truth,
                                  int64_t max_difference_ns, Convention convention) {
  if (convention == Convention::kTum)
    return associate_stamps(stamps_of(truth), stamps_of(estimate), max_difference_ns);
  std::vector<StampPair> pairs;
  if (estimate.empty() || truth.empty()) return pairs;
  const double max_difference_s = rounded_seconds(max_difference_ns);
  if (estimate.size() > truth.size()) {
    for_each_closest(seconds_of(truth), seconds_of(estimate), max_difference_s,
                     [&](size_t of_truth, size_t of_estimate) {
                       pairs.push_back({of_truth, of_estimate});
                     });
  } else {
    for_each_closest(seconds_of(estimate), seconds_of(truth), max_difference_s,
                     [&](size_t of_estimate, size_t of_truth) {
                       pairs.push_back({of_truth, of_estimate});
                     });
  }
  return pairs;
}

std::optional<Similarity> align_poses(std::span<const SE3> a, std::span<const SE3> b, Alignment alignment) {
  require(a.size() == b.size(), "align_poses: numbers of poses differ");
  constexpr size_t kMinPairs = 3;
  if (a.size() < kMinPairs) return std::nullopt;
  if (alignment == Alignment::kNone) return Similarity{};

  const Moments m = moments_of(a, b);
  if (!m.covariance.allFinite()) return std::nullopt;
  const Svd svd = decompose(m.covariance);
  const Eigen::Matrix3d R = alignment == Alignment::kYaw ? aligning_yaw(m) : aligning_rotation(m, svd);
  double scale = 1;
  if (alignment == Alignment::kSim3) {
    // Umeyama 1991, Eq. 42.
    const auto& d = svd.singularValues();
    scale = (d(0) + d(1) + last_sign(svd) * d(2)) / m.variance_b;
    if (!(scale > 0) || !std::isfinite(scale)) return std::nullopt;
  }
  return Similarity{scale, {Eigen::Quaterniond(R).normalized(), m.mean_a - scale * (R * m.mean_b)}};
}

}  // namespace kinloop
