#include "kinloop/optimize/moving_pose.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/bundle_model.hpp"

namespace kinloop {
namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

constexpr double kStepConverged = 1e-7;  // m, rad and their rates
constexpr double kCostConverged =
    1e-6;  // relative: of hundreds of observations, far below one standard deviation

/// Normal equations by (pose; velocity) at one state.
struct Normal {
  Matrix12d H = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();
  double cost = 0;
};

class Solver {
 public:
  Solver(const PinholeCamera& camera, const SensorVector& sensor,
         std::span<const MovingObservation> observations, const MovingPose& guess, const VelocitySigma& sigma,
         const AbsolutePoseOptions& options)
      : sensor_(sensor), observations_(observations), guess_(guess), options_(options) {
    problem_.camera = camera;
    bundle_.inverse_depth_sigma_per_m = options.inverse_depth_sigma_per_m;
    bundle_.velocity_sigma_m_s = sigma.m_s;
    bundle_.velocity_sigma_rad_s = sigma.rad_s;
    for (const MovingObservation& o : observations) {
      uses_.push_back(o.seen.depth_m > 0 ? BundleUse::kPixelAndDepth : BundleUse::kPixel);
    }
  }

  /// Tells inliers from outliers; true when anything changed.
  bool classify(const MovingPose& pose) {
    const BundleView view(pose.T_world_camera, pose.velocity);
    bool changed = false;
    for (size_t i = 0; i < observations_.size(); ++i) {
      const bool has_depth = observations_[i].seen.depth_m > 0;
      const BundleUse best = has_depth ? BundleUse::kPixelAndDepth : BundleUse::kPixel;
      const BundleResidual r =
          bundle_residual(task_, observations_[i].seen, best, view, observations_[i].p_world, sensor_);
      const bool agrees = r.seen && r.pixel_squared() <= options_.inlier_chi2_pixel;
      const bool depth_agrees = has_depth && r.depth_squared() <= options_.inlier_chi2_depth;
      const BundleUse use = !agrees        ? BundleUse::kNothing
                            : depth_agrees ? BundleUse::kPixelAndDepth
                                           : BundleUse::kPixel;
      changed = changed || use != uses_[i];
      uses_[i] = use;
    }
    return changed;
  }

  [[nodiscard]] int inliers() const {
    return static_cast<int>(observations_.size()) -
           static_cast<int>(std::count(uses_.begin(), uses_.end(), BundleUse::kNothing));
  }

  /// Moves pose and velocity to the least cost of what is in use now (Levenberg-Marquardt).
  [[nodiscard]] MovingPose minimize(MovingPose pose) const {
    Normal normal = linearize(pose);
    double damping = 1e-6;
    for (int i = 0; i < options_.max_iterations; ++i) {
      Matrix12d H = normal.H;
      H.diagonal() *= 1 + damping;
      const Vector12d step = -H.ldlt().solve(normal.g);
      if (!step.allFinite() || step.norm() < kStepConverged) break;
      const MovingPose candidate{pose.T_world_camera * SE3::exp(step.head<6>()),
                                 pose.velocity + step.tail<6>()};
      Normal next = linearize(candidate);
      if (next.cost >= normal.cost) {
        damping *= 100;
        continue;
      }
      const bool done = normal.cost - next.cost < kCostConverged * normal.cost;
      pose = candidate;
      normal = next;
      damping /= 10;
      if (done) break;
    }
    return pose;
  }

 private:
  [[nodiscard]] Normal linearize(const MovingPose& pose) const {
    Normal normal;
    const BundleView view(pose.T_world_camera, pose.velocity);
    const HuberLoss loss{options_.robust_width};
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (uses_[i] == BundleUse::kNothing) continue;
      const auto linear = linearize_observation(task_, observations_[i].seen, uses_[i], view,
                                                observations_[i].p_world, sensor_, {true, false});
      const BundleResidual& r = linear.residual;
      if (!r.seen) {
        normal.cost += loss.rho(kUnseenSquared);
        continue;
      }
      const double of_pixel = loss.weight(r.pixel_squared()), of_depth = loss.weight(r.depth_squared());
      Eigen::Matrix<double, 3, 12> J;
      J << linear.jacobian.pose, linear.jacobian.velocity;
      const Eigen::Vector3d weights(of_pixel, of_pixel, of_depth);
      const Eigen::Matrix<double, 3, 12> weighted = weights.asDiagonal() * J;
      normal.H.noalias() += weighted.transpose().lazyProduct(J);
      normal.g.noalias() += weighted.transpose().lazyProduct(r.e);
      normal.cost += loss.rho(r.pixel_squared()) + loss.rho(r.depth_squared());
    }
    const Vector6d information = velocity_information(bundle_);
    const Vector6d off = pose.velocity - guess_.velocity;
    normal.H.diagonal().tail<6>() += information;
    normal.g.tail<6>() += information.cwiseProduct(off);
    normal.cost += off.dot(information.cwiseProduct(off));
    return normal;
  }

  BundleProblem problem_;  // the camera alone
  BundleOptions bundle_;
  BundleTask task_{problem_, bundle_, {}, {}, {}};
  const SensorVector& sensor_;
  std::span<const MovingObservation> observations_;
  const MovingPose& guess_;
  const AbsolutePoseOptions& options_;
  std::vector<BundleUse> uses_;
};

}  // namespace

std::optional<MovingPose> solve_moving_pose(const PinholeCamera& camera, const SensorVector& sensor,
                                            std::span<const MovingObservation> observations,
                                            const MovingPose& guess, const VelocitySigma& sigma,
                                            const AbsolutePoseOptions& options) {
  Solver solver(camera, sensor, observations, guess, sigma, options);
  MovingPose pose = guess;
  for (int round = 0; round < options.rounds; ++round) {
    pose = solver.minimize(pose);
    const bool changed = solver.classify(pose);
    if (solver.inliers() < options.min_inliers) return std::nullopt;
    if (!changed) break;
  }
  return pose;
}

}  // namespace kinloop
