#include "kinloop/optimize/pose/ransac/rigid_ransac.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "kinloop/geometry/rigid_alignment.hpp"
#include "kinloop/optimize/pose/ransac/ransac.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kPointsPerSample = 3;

/// Covariance of a point measured by pixel and inverse depth: p = (x, y, 1) / w.
Eigen::Matrix3d point_covariance(const Sensor& sensor, const Eigen::Vector3d& p, double sigma_px) {
  const double z = p.z();
  const Eigen::Vector3d along =
      z * sensor.noise.point_pair.inverse_sigma_per_m(1 / z) * p;  // dp / dw * sigma_w = z * p * sigma_w
  Eigen::Matrix3d covariance = along * along.transpose();
  covariance(0, 0) += std::pow(z * sigma_px / sensor.camera.fx, 2);
  covariance(1, 1) += std::pow(z * sigma_px / sensor.camera.fy, 2);
  return covariance;
}

struct PairWithCovariance {
  Eigen::Vector3d p_a, p_b;
  Eigen::Matrix3d covariance_a, covariance_b;
  uint32_t index = 0;  // index in the input
};

std::vector<PairWithCovariance> pairs_with_covariance(const Sensor& sensor,
                                                      std::span<const PointPair> pairs) {
  std::vector<PairWithCovariance> weighed;
  for (uint32_t i = 0; i < pairs.size(); ++i) {
    const PointPair& pair = pairs[i];
    const bool usable = pair.p_a.allFinite() && pair.p_b.allFinite() && pair.p_a.z() > 0 &&
                        pair.p_b.z() > 0 && pair.sigma_a_px > 0 && pair.sigma_b_px > 0;
    if (!usable) continue;
    weighed.push_back({pair.p_a, pair.p_b, point_covariance(sensor, pair.p_a, pair.sigma_a_px),
                       point_covariance(sensor, pair.p_b, pair.sigma_b_px), i});
  }
  return weighed;
}

/// The error of a point pair under a motion, and its inverse covariance.
struct PairError {
  Eigen::Vector3d error;
  Eigen::Matrix3d information;

  PairError(const PairWithCovariance& pair, const Eigen::Matrix3d& R_a_b, const Eigen::Vector3d& t_a_b)
      : error(R_a_b * pair.p_b + t_a_b - pair.p_a),
        information((pair.covariance_a + R_a_b * pair.covariance_b * R_a_b.transpose()).inverse()) {}

  [[nodiscard]] double squared() const { return error.dot(information * error); }
};

int count_inliers(const std::vector<PairWithCovariance>& pairs, const SE3& T_a_b) {
  const Eigen::Matrix3d R = T_a_b.R();
  int count = 0;
  for (const PairWithCovariance& pair : pairs) {
    count += PairError(pair, R, T_a_b.translation).squared() <= kChi2At95With3Dof;
  }
  return count;
}

/// One Gauss-Newton step on the inliers of a motion (cost of generalised ICP, Segal et al. 2009).
struct Linearized {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double chi2 = 0;
  std::vector<uint32_t> inliers;  // indices in the input
};

Linearized linearize(const std::vector<PairWithCovariance>& pairs, const SE3& T_a_b) {
  const Eigen::Matrix3d R = T_a_b.R();
  Linearized l;
  for (const PairWithCovariance& pair : pairs) {
    const PairError e(pair, R, T_a_b.translation);
    const double squared = e.squared();
    if (!(squared <= kChi2At95With3Dof)) continue;
    Eigen::Matrix<double, 3, 6> J;  // with respect to x of T * exp(x)
    J << R, -R * skew(pair.p_b);
    const Eigen::Matrix<double, 6, 3> weighted = J.transpose() * e.information;
    l.H += weighted * J;
    l.g += weighted * e.error;
    l.chi2 += squared;
    l.inliers.push_back(pair.index);
  }
  return l;
}

std::optional<RigidSolution> refine(const std::vector<PairWithCovariance>& pairs, size_t pair_count,
                                    SE3 T_a_b) {
  constexpr int kMaxRefinements = 10;
  constexpr double kStepConverged = 1e-9;  // m and rad
  constexpr double kMinRelativeStiffness = 1e-9;
  for (int i = 0; i < kMaxRefinements; ++i) {
    const Linearized l = linearize(pairs, T_a_b);
    if (l.inliers.size() < kPointsPerSample) return std::nullopt;
    const Vector6d step = -l.H.ldlt().solve(l.g);
    if (!step.allFinite()) return std::nullopt;
    T_a_b = T_a_b * SE3::exp(step);
    if (step.norm() < kStepConverged) break;
  }
  const Linearized l = linearize(pairs, T_a_b);
  const auto eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix6d>(l.H, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(eigenvalues(0) > kMinRelativeStiffness * eigenvalues(5))) return std::nullopt;
  RigidSolution solution{T_a_b, std::vector<uint8_t>(pair_count, 0), static_cast<int>(l.inliers.size()), l.H,
                         l.chi2};
  for (const uint32_t i : l.inliers) solution.inliers[i] = 1;
  return solution;
}

/// Returns the motion of three pairs by Horn's method.
std::optional<SE3> motion_of_sample(const std::vector<PairWithCovariance>& pairs,
                                    const std::vector<uint32_t>& sample) {
  std::array<Eigen::Vector3d, kPointsPerSample> a, b;
  for (size_t k = 0; k < kPointsPerSample; ++k) {
    a[k] = pairs[sample[k]].p_a;
    b[k] = pairs[sample[k]].p_b;
  }
  return align_rigid(a, b);
}

}  // namespace

std::optional<RigidSolution> solve_rigid_ransac(const Sensor& sensor, std::span<const PointPair> pairs,
                                                const RigidRansacOptions& options, uint64_t seed) {
  const auto weighed = pairs_with_covariance(sensor, pairs);
  const int needed = std::max<int>(options.min_inliers, kPointsPerSample);
  if (weighed.size() < static_cast<size_t>(needed)) return std::nullopt;

  Random random(seed);
  std::optional<RigidSolution> best;
  int best_count = 0;  // inlier count of the best sample before refinement
  double samples = options.max_iterations;
  for (int i = 0; i < samples; ++i) {
    const auto sample =
        sample_without_replacement(random, static_cast<uint32_t>(weighed.size()), kPointsPerSample);
    const auto T_a_b = motion_of_sample(weighed, sample);
    if (!T_a_b) continue;
    const int count = count_inliers(weighed, *T_a_b);
    if (count <= best_count) continue;
    best_count = count;
    const auto refined = refine(weighed, pairs.size(), *T_a_b);
    if (!refined || (best && refined->inlier_count <= best->inlier_count)) continue;
    best = refined;
    samples = std::min(
        samples, required_samples(best->inlier_count, weighed.size(), kPointsPerSample, options.confidence));
  }
  if (!best || best->inlier_count < needed) return std::nullopt;
  return best;
}

std::optional<RigidSolution> refine_rigid(const Sensor& sensor, std::span<const PointPair> pairs,
                                          const SE3& T_a_b_guess, const RigidRansacOptions& options) {
  if (!T_a_b_guess.is_finite()) return std::nullopt;
  const auto weighed = pairs_with_covariance(sensor, pairs);
  auto solution = refine(weighed, pairs.size(), T_a_b_guess);
  if (!solution || solution->inlier_count < options.min_inliers) return std::nullopt;
  return solution;
}

}  // namespace kinloop
