#include "kinloop/optimize/absolute_pose.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "kinloop/geometry/robust_loss.hpp"

namespace kinloop {
namespace {

constexpr double kMinDepth_m = 1e-3;            // nearer (or behind) is not seen
constexpr double kUnseenSquared = 1e6;          // squared residual of a point that moved behind the camera
constexpr double kStepConverged = 1e-7;         // m and rad
constexpr double kCostConverged = 1e-9;         // relative
constexpr double kMinRelativeStiffness = 1e-9;  // smallest eigenvalue of the scaled information matrix

/// What of an observation is used.
enum class Use : uint8_t { kNothing, kPixel, kPixelAndDepth };

/// Normalised residuals of one observation, du, dv and inverse depth.
struct Residual {
  double x = 0, y = 0, inverse_z = 0;  // of the predicted point, x / z, y / z, 1 / z
  double u = 0, v = 0, w = 0;
  bool seen = false;

  [[nodiscard]] double pixel_squared() const { return u * u + v * v; }
  [[nodiscard]] double depth_squared() const { return w * w; }
};

/// A pose in the form the inner loop needs: a matrix rotates a point faster than a quaternion.
struct InversePose {
  Eigen::Matrix3d R_camera_reference;
  Eigen::Vector3d center;

  explicit InversePose(const SE3& T) : R_camera_reference(T.R().transpose()), center(T.translation) {}
};

Residual residual_of(const PinholeCamera& camera, const PoseObservation& o, const InversePose& pose,
                     double inverse_depth_sigma) {
  const Eigen::Vector3d p = pose.R_camera_reference * (o.p_reference - pose.center);
  Residual r;
  if (!(p.z() > kMinDepth_m)) return r;
  r.seen = true;
  r.inverse_z = 1.0 / p.z();
  r.x = p.x() * r.inverse_z;
  r.y = p.y() * r.inverse_z;
  r.u = (camera.fx * r.x + camera.cx - o.pixel.x()) / o.sigma_px;
  r.v = (camera.fy * r.y + camera.cy - o.pixel.y()) / o.sigma_px;
  if (o.depth_m > 0) r.w = (r.inverse_z - 1.0 / o.depth_m) / inverse_depth_sigma;
  return r;
}

/// Normal equations of the robust cost at one pose.
struct Normal {
  Matrix6d H = Matrix6d::Zero();  // lower triangle
  Vector6d g = Vector6d::Zero();
  double cost = 0;

  void add(const Vector6d& J, double residual, double weight) {
    for (int c = 0; c < 6; ++c) {
      const double scaled = weight * J(c);
      g(c) += scaled * residual;
      for (int r = c; r < 6; ++r) H(r, c) += scaled * J(r);
    }
  }
};

/// Derivatives by x of the pose T * exp(x): the point moves by -rho + p x omega in the camera frame.
void add_observation(const PinholeCamera& camera, const PoseObservation& o, const Residual& r,
                     const HuberLoss& loss, Normal& normal) {
  const double x = r.x, y = r.y, w = r.inverse_z;
  const double fx = camera.fx / o.sigma_px, fy = camera.fy / o.sigma_px;
  const double weight = loss.weight(r.pixel_squared());
  Vector6d J;
  J << -fx * w, 0, fx * x * w, fx * x * y, -fx * (1 + x * x), fx * y;
  normal.add(J, r.u, weight);
  J << 0, -fy * w, fy * y * w, fy * (1 + y * y), -fy * x * y, -fy * x;
  normal.add(J, r.v, weight);
}

void add_depth(const Residual& r, double inverse_depth_sigma, const HuberLoss& loss, Normal& normal) {
  const double w = r.inverse_z;
  Vector6d J;
  J << 0, 0, w * w, w * r.y, -w * r.x, 0;
  normal.add(J / inverse_depth_sigma, r.w, loss.weight(r.depth_squared()));
}

/// The problem with the scratch that its rounds share.
class Solver {
 public:
  Solver(const PinholeCamera& camera, std::span<const PoseObservation> observations,
         const AbsolutePoseOptions& options, const std::optional<PosePrior>& prior)
      : camera_(camera), observations_(observations), options_(options), prior_(prior) {
    uses_.reserve(observations.size());
    for (const PoseObservation& o : observations) {
      const bool finite = o.p_reference.allFinite() && o.pixel.allFinite() && o.sigma_px > 0;
      const bool has_depth = o.depth_m > 0 && std::isfinite(o.depth_m);
      uses_.push_back(!finite ? Use::kNothing : has_depth ? Use::kPixelAndDepth : Use::kPixel);
    }
    usable_ = uses_;
  }

  /// Moves the pose to the least cost of what is in use now.
  SE3 minimize(SE3 T) const {
    Normal normal = linearize(T);
    double damping = kFirstDamping;
    for (int i = 0; i < options_.max_iterations; ++i) {
      Matrix6d H = normal.H.selfadjointView<Eigen::Lower>();
      H.diagonal() *= 1 + damping;
      const Vector6d step = -H.ldlt().solve(normal.g);
      if (!step.allFinite()) break;
      const SE3 candidate = T * SE3::exp(step);
      const Normal next = linearize(candidate);
      if (next.cost > normal.cost) {
        if (step.norm() < kStepConverged) break;
        damping *= 10 * 10;
        continue;
      }
      const bool done =
          step.norm() < kStepConverged || normal.cost - next.cost < kCostConverged * normal.cost;
      T = candidate;
      normal = next;
      damping /= 10;
      if (done) break;
    }
    return T;
  }

  /// Tells inliers from outliers at a pose; true when anything changed.
  bool classify(const SE3& T) {
    const InversePose pose(T);
    bool changed = false;
    for (size_t i = 0; i < observations_.size(); ++i) {
      const Use use = use_at(i, pose);
      changed = changed || use != uses_[i];
      uses_[i] = use;
    }
    return changed;
  }

  [[nodiscard]] AbsolutePoseSolution solution(const SE3& T) const {
    AbsolutePoseSolution s;
    s.T_reference_camera = T;
    s.inliers.assign(observations_.size(), 0);
    const InversePose pose(T);
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (uses_[i] == Use::kNothing) continue;
      const Residual r = residual_of(camera_, observations_[i], pose, options_.inverse_depth_sigma_per_m);
      s.inliers[i] = 1;
      ++s.inlier_count;
      s.chi2 += r.pixel_squared() + (uses_[i] == Use::kPixelAndDepth ? r.depth_squared() : 0);
    }
    // What inliers tell is what they measure, not the weights they were found with; a robust estimate uses
    // the share of it that its efficiency says.
    const Matrix6d H =
        linearize(T, std::numeric_limits<double>::infinity()).H.selfadjointView<Eigen::Lower>();
    s.information = huber_efficiency(options_.robust_width) * H;
    return s;
  }

 private:
  static constexpr double kFirstDamping = 1e-6;

  [[nodiscard]] Use use_at(size_t i, const InversePose& pose) const {
    if (usable_[i] == Use::kNothing) return Use::kNothing;
    const Residual r = residual_of(camera_, observations_[i], pose, options_.inverse_depth_sigma_per_m);
    if (!r.seen || r.pixel_squared() > options_.inlier_chi2_pixel) return Use::kNothing;
    if (usable_[i] == Use::kPixel || r.depth_squared() > options_.inlier_chi2_depth) return Use::kPixel;
    return Use::kPixelAndDepth;
  }

  [[nodiscard]] Normal linearize(const SE3& T) const { return linearize(T, options_.robust_width); }

  [[nodiscard]] Normal linearize(const SE3& T, double robust_width) const {
    Normal normal;
    const InversePose pose(T);
    const double sigma = options_.inverse_depth_sigma_per_m;
    const HuberLoss loss{robust_width};
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (uses_[i] == Use::kNothing) continue;
      const Residual r = residual_of(camera_, observations_[i], pose, sigma);
      if (!r.seen) {
        normal.cost += loss.rho(kUnseenSquared);
        continue;
      }
      add_observation(camera_, observations_[i], r, loss, normal);
      normal.cost += loss.rho(r.pixel_squared());
      if (uses_[i] != Use::kPixelAndDepth) continue;
      add_depth(r, sigma, loss, normal);
      normal.cost += loss.rho(r.depth_squared());
    }
    if (prior_) add_prior(T, normal);
    return normal;
  }

  /// A prior near the pose: its error moves with the pose one to one.
  void add_prior(const SE3& T, Normal& normal) const {
    const Vector6d error = (prior_->T_reference_camera.inverse() * T).log();
    const Vector6d weighted = prior_->information * error;
    normal.H += prior_->information;
    normal.g += weighted;
    normal.cost += error.dot(weighted);
  }

  const PinholeCamera& camera_;
  std::span<const PoseObservation> observations_;
  const AbsolutePoseOptions& options_;
  const std::optional<PosePrior>& prior_;
  std::vector<Use> uses_;    // now
  std::vector<Use> usable_;  // at best
};

/// Whether every direction of the pose is held, judged with each coordinate scaled to one.
bool is_constrained(const Matrix6d& information) {
  const Vector6d diagonal = information.diagonal();
  if (!(diagonal.minCoeff() > 0) || !information.allFinite()) return false;
  const Vector6d scale = diagonal.cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0) > kMinRelativeStiffness;
}

}  // namespace

std::optional<AbsolutePoseSolution> solve_absolute_pose(const PinholeCamera& camera,
                                                        std::span<const PoseObservation> observations,
                                                        const SE3& T_reference_camera_guess,
                                                        const AbsolutePoseOptions& options,
                                                        const std::optional<PosePrior>& prior) {
  if (!T_reference_camera_guess.is_finite()) return std::nullopt;
  Solver solver(camera, observations, options, prior);
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

std::vector<uint8_t> agreeing_observations(const PinholeCamera& camera,
                                           std::span<const PoseObservation> observations,
                                           const SE3& T_reference_camera,
                                           const AbsolutePoseOptions& options) {
  const InversePose pose(T_reference_camera);
  std::vector<uint8_t> agree;
  agree.reserve(observations.size());
  for (const PoseObservation& o : observations) {
    const Residual r = residual_of(camera, o, pose, options.inverse_depth_sigma_per_m);
    agree.push_back(r.seen && r.pixel_squared() <= options.inlier_chi2_pixel);  // false for NaN
  }
  return agree;
}

}  // namespace kinloop
