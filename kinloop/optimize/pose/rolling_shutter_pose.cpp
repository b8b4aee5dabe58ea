#include <limits>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"
#include "kinloop/optimize/pose/moving_pose.hpp"
#include "kinloop/optimize/pose/pose_minimizer.hpp"

namespace kinloop {
namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;

class RollingShutterSolver {
 public:
  RollingShutterSolver(const Sensor& sensor, std::span<const PoseObservation> observations,
                       const Velocity& prior, const VelocitySigma& sigma, const AbsolutePoseOptions& options)
      : sensor_(sensor), observations_(observations_of(observations)), prior_(prior), options_(options) {
    information_ << Eigen::Vector3d::Constant(1 / (sigma.m_s * sigma.m_s)),
        Eigen::Vector3d::Constant(1 / (sigma.rad_s * sigma.rad_s));
  }

  /// Classifies inliers and outliers; true if anything changed.
  bool classify(const RollingShutterPose& pose) { return observations_.classify(view_of(pose), sensor_); }

  void classify_guess(const RollingShutterPose& guess) {
    observations_.classify_guess(view_of(guess), sensor_, options_.min_inliers);
  }

  [[nodiscard]] int inliers() const { return observations_.inlier_count(); }

  /// Minimizes the cost over pose and velocity, with the observations in use.
  [[nodiscard]] RollingShutterPose minimize(const RollingShutterPose& pose) const {
    return minimize_pose<12>(
        pose, options_.max_iterations,
        [this](const RollingShutterPose& at) { return linearize(at, sensor_); },
        [](const RollingShutterPose& at, const Vector12d& step) {
          return RollingShutterPose{at.T_world_camera * SE3::exp(step.head<6>()),
                                    Velocity::from_vector(at.velocity.vector() + step.tail<6>())};
        });
  }

  /// Returns RollingShutterSolution::covariance. The velocity is eliminated (Schur complement). The
  /// information is that without robust weights, which would count large residuals twice: they also make the
  /// variance large.
  [[nodiscard]] Matrix6d covariance(const RollingShutterPose& pose) const {
    Sensor unweighted = sensor_;
    unweighted.noise.robust_width = std::numeric_limits<double>::infinity();
    const double variance = observations_.residual_squares(view_of(pose), sensor_).variance(SE3::kDof) /
                            huber_efficiency(sensor_.noise.robust_width);
    const Eigen::LDLT<Eigen::Matrix<double, 12, 12>> factor(linearize(pose, unweighted).H);
    const Eigen::Matrix<double, 12, 6> columns = factor.solve(Eigen::Matrix<double, 12, 6>::Identity());
    return variance * columns.topRows<6>();
  }

 private:
  static BundleView view_of(const RollingShutterPose& pose) { return {pose.T_world_camera, pose.velocity}; }

  [[nodiscard]] PoseNormal<12> linearize(const RollingShutterPose& pose, const Sensor& sensor) const {
    static const LinearColumns kColumns = LinearColumns::of_pose_and_velocity();
    const auto observed = observations_.linearize(view_of(pose), sensor, kColumns);
    constexpr auto kResidual =
        static_cast<Eigen::Index>(LinearColumns::kResidual);  // between pose and velocity
    const Eigen::Matrix<double, 13, 13> gram = observed.gram.selfadjointView<Eigen::Upper>();
    PoseNormal<12> normal;
    normal.H << gram.topLeftCorner<6, 6>(), gram.topRightCorner<6, 6>(), gram.bottomLeftCorner<6, 6>(),
        gram.bottomRightCorner<6, 6>();
    normal.g << gram.col(kResidual).head<6>(), gram.col(kResidual).tail<6>();
    const Vector6d off = pose.velocity.vector() - prior_.vector();
    normal.H.diagonal().tail<6>() += information_;
    normal.g.tail<6>() += information_.cwiseProduct(off);
    normal.cost = observed.cost + off.dot(information_.cwiseProduct(off));
    return normal;
  }

  const Sensor& sensor_;
  CameraObservations observations_;
  const Velocity& prior_;
  Vector6d information_;  // prior information of the velocity
  const AbsolutePoseOptions& options_;
};

}  // namespace

std::optional<RollingShutterSolution> solve_rolling_shutter_pose(
    const Sensor& sensor, std::span<const PoseObservation> observations, const RollingShutterPose& guess,
    const VelocitySigma& sigma, const AbsolutePoseOptions& options) {
  RollingShutterSolver solver(sensor, observations, guess.velocity, sigma, options);
  RollingShutterPose pose = guess;
  solver.classify_guess(pose);
  for (int round = 0; round < options.rounds; ++round) {
    pose = solver.minimize(pose);
    const bool changed = solver.classify(pose);
    if (solver.inliers() < options.min_inliers) return std::nullopt;
    if (!changed) break;
  }
  return RollingShutterSolution{pose, solver.covariance(pose)};
}

}  // namespace kinloop
