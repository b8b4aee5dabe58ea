#include "kinloop/optimize/moving_pose.hpp"

#include <Eigen/Cholesky>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/bundle_model.hpp"

namespace kinloop {
namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

constexpr double kStepConverged = 1e-9;

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

  /// Tells inliers from outliers and counts them.
  int classify(const MovingPose& pose) {
    const BundleView view(pose.T_world_camera, pose.velocity);
    int inliers = 0;
    for (size_t i = 0; i < observations_.size(); ++i) {
      const bool has_depth = observations_[i].seen.depth_m > 0;
      const BundleResidual r = residual(i, view, has_depth ? BundleUse::kPixelAndDepth : BundleUse::kPixel);
      const bool agrees = r.seen && r.pixel_squared() <= options_.inlier_chi2_pixel;
      const bool depth_agrees = has_depth && r.depth_squared() <= options_.inlier_chi2_depth;
      uses_[i] = !agrees ? BundleUse::kNothing : depth_agrees ? BundleUse::kPixelAndDepth : BundleUse::kPixel;
      inliers += agrees ? 1 : 0;
    }
    return inliers;
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
      pose = candidate;
      normal = next;
      damping /= 10;
    }
    return pose;
  }

 private:
  [[nodiscard]] BundleTask task() const { return {problem_, bundle_, {}, {}, {}}; }

  [[nodiscard]] BundleResidual residual(size_t i, const BundleView& view, BundleUse use) const {
    return bundle_residual(task(), observations_[i].seen, use, view, observations_[i].p_world, sensor_);
  }

  [[nodiscard]] Normal linearize(const MovingPose& pose) const {
    Normal normal;
    const BundleView view(pose.T_world_camera, pose.velocity);
    const HuberLoss loss{options_.robust_width};
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (uses_[i] == BundleUse::kNothing) continue;
      const auto linear = linearize_observation(task(), observations_[i].seen, uses_[i], view,
                                                observations_[i].p_world, sensor_);
      const BundleResidual& r = linear.residual;
      if (!r.seen) {
        normal.cost += loss.rho(kUnseenSquared);
        continue;
      }
      const double of_pixel = loss.weight(r.pixel_squared()), of_depth = loss.weight(r.depth_squared());
      Eigen::Matrix<double, 3, 12> J;
      J << linear.jacobian.pose, linear.jacobian.velocity;
      const Eigen::Vector3d weights(of_pixel, of_pixel, of_depth);
      normal.H += J.transpose() * weights.asDiagonal() * J;
      normal.g += J.transpose() * weights.cwiseProduct(r.e);
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
  int inliers = 0;
  for (int round = 0; round < options.rounds; ++round) {
    pose = solver.minimize(pose);
    inliers = solver.classify(pose);
    if (inliers < options.min_inliers) return std::nullopt;
  }
  return pose;
}

}  // namespace kinloop
