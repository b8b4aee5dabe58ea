#include "kinloop/optimize/pose/absolute_pose.hpp"

#include <limits>

#include <Eigen/Eigenvalues>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"
#include "kinloop/optimize/pose/pose_minimizer.hpp"

namespace kinloop {
namespace {

constexpr double kMinRelativeStiffness = 1e-9;  // smallest eigenvalue of the scaled information matrix

BundleView static_view(const SE3& T_reference_camera) {
  return {T_reference_camera, Velocity{}};
}

class Solver {
 public:
  Solver(const Sensor& sensor, std::span<const PoseObservation> observations,
         const AbsolutePoseOptions& options, const std::optional<PosePrior>& prior)
      : sensor_(without_corrections(sensor)),
        observations_(observations_of(observations)),
        options_(options),
        prior_(prior) {}

  /// Minimizes the cost over the observations in use.
  [[nodiscard]] SE3 minimize(const SE3& T) const {
    return minimize_pose<6>(
        T, options_.max_iterations, [this](const SE3& at) { return linearize(at); },
        [](const SE3& at, const Vector6d& step) { return at * SE3::exp(step); });
  }

  /// Classifies inliers and outliers at a pose; true if anything changed.
  bool classify(const SE3& T) { return observations_.classify(static_view(T), sensor_); }

  [[nodiscard]] AbsolutePoseSolution solution(const SE3& T) const {
    AbsolutePoseSolution s;
    s.T_reference_camera = T;
    s.inliers = observations_.inliers();
    s.inlier_count = observations_.inlier_count();
    // The information is that of the measurements, without robust weights, scaled by the efficiency of the
    // robust estimator.
    Sensor unweighted = sensor_;
    unweighted.noise.robust_width = std::numeric_limits<double>::infinity();
    const PoseNormal<6> observed = observations_.linearize_pose(static_view(T), unweighted);
    s.chi2 = observed.cost;
    const double efficiency = huber_efficiency(sensor_.noise.robust_width);
    s.information = efficiency * observed.H;
    if (prior_) {
      // (H + P) - P in place of H, so that results keep their last bit.
      const Matrix6d both = observed.H + prior_->information;
      s.information = efficiency * (both - prior_->information) + prior_->information;
    }
    return s;
  }

 private:
  /// The observations and the prior, if there is one.
  [[nodiscard]] PoseNormal<6> linearize(const SE3& T) const {
    const PoseNormal<6> normal = observations_.linearize_pose(static_view(T), sensor_);
    return prior_ ? with_prior(normal, *prior_, T) : normal;
  }

  Sensor sensor_;
  CameraObservations observations_;
  const AbsolutePoseOptions& options_;
  const std::optional<PosePrior>& prior_;
};

/// Whether every direction of the pose is constrained, after scaling each coordinate to one.
bool is_constrained(const Matrix6d& information) {
  const Vector6d diagonal = information.diagonal();
  if (!(diagonal.minCoeff() > 0) || !information.allFinite()) return false;
  const Vector6d scale = diagonal.cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0) > kMinRelativeStiffness;
}

}  // namespace

std::optional<AbsolutePoseSolution> solve_absolute_pose(const Sensor& sensor,
                                                        std::span<const PoseObservation> observations,
                                                        const SE3& T_reference_camera_guess,
                                                        const AbsolutePoseOptions& options,
                                                        const std::optional<PosePrior>& prior) {
  if (!T_reference_camera_guess.is_finite()) return std::nullopt;
  Solver solver(sensor, observations, options, prior);
  SE3 T = T_reference_camera_guess;
  for (int round = 0; round < options.rounds; ++round) {
    T = solver.minimize(T);
    if (!solver.classify(T)) break;
  }
  AbsolutePoseSolution solution = solver.solution(T);
  if (solution.inlier_count < options.min_inliers || !is_constrained(solution.information)) {
    return std::nullopt;
  }
  return solution;
}

std::vector<uint8_t> pixel_inliers(const Sensor& sensor, std::span<const PoseObservation> observations,
                                   const SE3& T_reference_camera) {
  const PinholeCamera& camera = sensor.camera;
  const Eigen::Matrix3d R_camera_reference = T_reference_camera.R().transpose();
  const Eigen::Vector2d focal(camera.fx, camera.fy), center(camera.cx, camera.cy);
  std::vector<uint8_t> agree;
  agree.reserve(observations.size());
  for (const PoseObservation& o : observations) {
    const Eigen::Vector3d p = R_camera_reference * (o.p_reference - T_reference_camera.translation);
    const Eigen::Vector2d pixel = focal.cwiseProduct(p.head<2>()) / p.z() + center;
    const double squared = (pixel - o.pixel).squaredNorm() / (o.sigma_px * o.sigma_px);
    agree.push_back(p.z() > kMinObservedDepth_m &&
                    squared <= sensor.noise.inlier_chi2_pixel);  // false for NaN
  }
  return agree;
}

}  // namespace kinloop
