#include "kinloop/optimize/bundle_model.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "kinloop/geometry/robust_loss.hpp"

namespace kinloop {
namespace {

constexpr double kMinDepth_m = 1e-3;  // nearer (or behind) is not seen

/// The turn of a camera within a frame, exp([phi]_x) by Rodrigues' formula: v + phi x (a v + b phi x v). The
/// angle is small, and a few terms of the series of a and b are exact: cheaper than sine and cosine.
class SmallRotation {
 public:
  explicit SmallRotation(const Eigen::Vector3d& phi) : phi_(phi) {
    constexpr double kMaxSquared = 0.01;  // the first term left out is below 3e-18
    const double t = phi.squaredNorm();
    if (t <= kMaxSquared) {
      a_ = 1 - t / 6 * (1 - t / 20 * (1 - t / 42 * (1 - t / 72)));
      b_ = 0.5 * (1 - t / 12 * (1 - t / 30 * (1 - t / 56 * (1 - t / 90))));
    } else {
      const double angle = std::sqrt(t);
      a_ = std::sin(angle) / angle;
      b_ = (1 - std::cos(angle)) / t;
    }
  }

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& v) const {
    return v + phi_.cross(a_ * v + b_ * phi_.cross(v));
  }
  [[nodiscard]] Eigen::Vector3d inverse_times(const Eigen::Vector3d& v) const {
    return v - phi_.cross(a_ * v - b_ * phi_.cross(v));
  }

 private:
  Eigen::Vector3d phi_;
  double a_ = 1;
  double b_ = 0.5;
};

/// A point in the axes of the camera, `dt_s` after the stamp of its frame: p = E (p0 - nu t), E = exp(-omega
/// t).
struct MovedPoint {
  SmallRotation E;
  Eigen::Vector3d p;
  double dt_s = 0;

  MovedPoint(const BundleView& view, const Eigen::Vector3d& p0, double dt)
      : E(-dt * view.velocity.tail<3>()), p(E * (p0 - dt * view.velocity.head<3>())), dt_s(dt) {}

  [[nodiscard]] bool is_seen() const { return p.z() > kMinDepth_m; }
};

/// Where the corrected camera sees a point, with the terms that the derivatives share.
struct Projection {
  double x, y, r2, bend, slope;
  double fx, fy;
  double inverse_z;
  Eigen::Vector2d pixel;

  Projection(const PinholeCamera& camera, const SensorVector& s, const Eigen::Vector3d& p)
      : fx(camera.fx + s(kFocalX)), fy(camera.fy + s(kFocalY)), inverse_z(1.0 / p.z()) {
    x = p.x() * inverse_z;
    y = p.y() * inverse_z;
    r2 = x * x + y * y;
    bend = 1 + r2 * (s(kRadial1) + r2 * s(kRadial2));
    slope = 2 * (s(kRadial1) + 2 * r2 * s(kRadial2));  // d bend / dx = x * slope
    pixel = {fx * x * bend + camera.cx + s(kCenterX), fy * y * bend + camera.cy + s(kCenterY)};
  }

  [[nodiscard]] Eigen::Matrix<double, 2, 3> by_point() const {
    const double ux = fx * (bend + x * x * slope) * inverse_z, uy = fx * x * y * slope * inverse_z;
    const double vx = fy * x * y * slope * inverse_z, vy = fy * (bend + y * y * slope) * inverse_z;
    Eigen::Matrix<double, 2, 3> J;
    J << ux, uy, -ux * x - uy * y, vx, vy, -vx * x - vy * y;
    return J;
  }

  /// By focal lengths, centre and radial distortion: the first six sensor parameters.
  [[nodiscard]] Eigen::Matrix<double, 2, 6> by_intrinsics() const {
    Eigen::Matrix<double, 2, 6> J;
    J << x * bend, 0, 1, 0, fx * x * r2, fx * x * r2 * r2, 0, y * bend, 0, 1, fy * y * r2, fy * y * r2 * r2;
    return J;
  }
};
static_assert(kFocalX == 0 && kRadial2 == 5, "by_intrinsics fills the first six parameters");

double color_time(const BundleObservation& o, const SensorVector& s) {
  return s(kRollingShutter) * o.row;
}

bool knows_slope(const BundleObservation& o) {
  return o.inverse_depth_gradient.allFinite();
}

/// When depth was measured. How a surface of unknown slope moves under a pixel is unknown, too: to take it
/// for flat would draw the delay towards zero, as most surfaces that cameras see from above rise away from
/// them.
double depth_time(const BundleObservation& o, const SensorVector& s) {
  return knows_slope(o) ? s(kDepthTime) + s(kDepthShutter) * o.row : color_time(o, s);
}

Eigen::Vector2d pixel_error(const BundleObservation& o, const Projection& at_color) {
  return (at_color.pixel - o.pixel) / o.sigma_px;
}

/// How measured inverse depth differs from that of the point at the time of the depth image.
double depth_error(const BundleTask& task, const BundleObservation& o, const SensorVector& s,
                   const Projection& at_depth) {
  double error = (1 + s(kDepthScale)) / o.depth_m - at_depth.inverse_z;
  error += s.segment<6>(kDepthOffset).dot(depth_offset_basis(task.problem.camera, o.pixel));
  if (knows_slope(o)) error += o.inverse_depth_gradient.dot(at_depth.pixel - o.pixel);
  return error / task.options.inverse_depth_sigma_per_m;
}

/// Fills one row of the Jacobian from `a`, the derivative of a residual by the moved point, and returns the
/// residual's derivative by time.
double fill_row(int row, const Eigen::Vector3d& a, const MovedPoint& moved, const BundleView& view,
                const Eigen::Vector3d& p0, const BundleDerivatives& wanted, BundleJacobian& J) {
  const Eigen::Vector3d b = moved.E.inverse_times(a);
  J.pose.row(row) << -b.transpose(), b.cross(p0).transpose();
  J.point.row(row) = b.transpose() * view.R_camera_world;
  const Eigen::Vector3d omega = view.velocity.tail<3>();
  if (wanted.velocity) {
    // d exp(phi) = [J_l(phi) d phi]_x exp(phi) with phi = -omega t; within a frame the angle is small and the
    // series of J_l short.
    const Eigen::Vector3d phi = -moved.dt_s * omega;
    const Eigen::Vector3d turn = a.cross(moved.p), first = turn.cross(phi), second = first.cross(phi);
    J.velocity.row(row) << -moved.dt_s * b.transpose(),
        moved.dt_s * (turn + first / 2 + second / 6 + second.cross(phi) / 24).transpose();
  }
  return -a.dot(omega.cross(moved.p)) - b.dot(view.velocity.head<3>());
}

void linearize_pixel(const BundleObservation& o, const MovedPoint& moved, const Projection& projection,
                     const BundleView& view, const Eigen::Vector3d& p0, const BundleDerivatives& wanted,
                     BundleJacobian& J) {
  const Eigen::Matrix<double, 2, 3> by_point = projection.by_point() / o.sigma_px;
  for (int row = 0; row < 2; ++row) {
    const double by_time = fill_row(row, by_point.row(row).transpose(), moved, view, p0, wanted, J);
    if (wanted.sensor) J.sensor(row, kRollingShutter) = by_time * o.row;
  }
  if (wanted.sensor) J.sensor.topLeftCorner<2, 6>() = projection.by_intrinsics() / o.sigma_px;
}

void linearize_depth(const BundleTask& task, const BundleObservation& o, const MovedPoint& moved,
                     const Projection& projection, const BundleView& view, const Eigen::Vector3d& p0,
                     const BundleDerivatives& wanted, BundleJacobian& J) {
  const double inverse_sigma = 1.0 / task.options.inverse_depth_sigma_per_m;
  Eigen::Vector3d a(0, 0, projection.inverse_z * projection.inverse_z);
  if (knows_slope(o)) a += projection.by_point().transpose() * o.inverse_depth_gradient;
  const double by_time = fill_row(2, inverse_sigma * a, moved, view, p0, wanted, J);
  if (!wanted.sensor) return;
  if (knows_slope(o)) {
    J.sensor.block<1, 6>(2, 0) =
        inverse_sigma * o.inverse_depth_gradient.transpose() * projection.by_intrinsics();
    J.sensor(2, kDepthTime) = by_time;
    J.sensor(2, kDepthShutter) = by_time * o.row;
  } else {
    J.sensor(2, kRollingShutter) = by_time * o.row;
  }
  J.sensor(2, kDepthScale) = inverse_sigma / o.depth_m;
  J.sensor.block<1, 6>(2, kDepthOffset) =
      inverse_sigma * depth_offset_basis(task.problem.camera, o.pixel).transpose();
}

}  // namespace

std::vector<BundleView> views_of(const BundleState& state) {
  std::vector<BundleView> views;
  views.reserve(state.T_world_camera.size());
  for (size_t i = 0; i < state.T_world_camera.size(); ++i) {
    views.emplace_back(state.T_world_camera[i], state.velocities[i]);
  }
  return views;
}

BundleResidual bundle_residual(const BundleTask& task, const BundleObservation& o, BundleUse use,
                               const BundleView& view, const Eigen::Vector3d& p_world,
                               const SensorVector& sensor) {
  const PinholeCamera& camera = task.problem.camera;
  BundleResidual residual;
  const Eigen::Vector3d p0 = view.R_camera_world * (p_world - view.center);
  const MovedPoint at_color(view, p0, color_time(o, sensor));
  if (!at_color.is_seen()) return residual;
  residual.e.head<2>() = pixel_error(o, Projection(camera, sensor, at_color.p));
  residual.seen = true;
  if (use != BundleUse::kPixelAndDepth) return residual;
  const MovedPoint at_depth(view, p0, depth_time(o, sensor));
  residual.seen = at_depth.is_seen();
  if (residual.seen) residual.e.z() = depth_error(task, o, sensor, Projection(camera, sensor, at_depth.p));
  return residual;
}

LinearizedObservation linearize_observation(const BundleTask& task, const BundleObservation& o, BundleUse use,
                                            const BundleView& view, const Eigen::Vector3d& p_world,
                                            const SensorVector& sensor, const BundleDerivatives& wanted) {
  const PinholeCamera& camera = task.problem.camera;
  LinearizedObservation linear;
  BundleJacobian& J = linear.jacobian;
  const Eigen::Vector3d p0 = view.R_camera_world * (p_world - view.center);
  const MovedPoint at_color(view, p0, color_time(o, sensor));
  if (!at_color.is_seen()) return linear;
  if (wanted.sensor) J.sensor.setZero();
  const Projection color(camera, sensor, at_color.p);
  linear.residual.e.head<2>() = pixel_error(o, color);
  linearize_pixel(o, at_color, color, view, p0, wanted, J);
  linear.residual.seen = true;
  if (use != BundleUse::kPixelAndDepth) {
    J.pose.row(2).setZero();
    J.velocity.row(2).setZero();
    J.point.row(2).setZero();
    return linear;
  }
  const MovedPoint at_depth(view, p0, depth_time(o, sensor));
  linear.residual.seen = at_depth.is_seen();
  if (!linear.residual.seen) return linear;
  const Projection depth(camera, sensor, at_depth.p);
  linear.residual.e.z() = depth_error(task, o, sensor, depth);
  linearize_depth(task, o, at_depth, depth, view, p0, wanted, J);
  return linear;
}

LinearizedEdge linearize_bundle_edge(const BundleEdge& edge, const SE3& T_world_a, const SE3& T_world_b) {
  const SE3 T_a_b = T_world_a.inverse() * T_world_b;
  const SE3 error = edge.T_a_b.inverse() * T_a_b;
  const Eigen::Vector3d phi = log_so3(error.rotation);
  // Inverse right Jacobian of SO(3) (Barfoot 2017, Eq. 7.77): log(exp(phi) exp(w)) = phi + J_r^-1(phi) w.
  const double angle = phi.norm();
  const Eigen::Matrix3d W = skew(phi);
  constexpr double kSmallAngle = 1e-4;
  const double b = angle < kSmallAngle ? 1.0 / 12
                                       : (1.0 - 0.5 * angle * std::cos(0.5 * angle) / std::sin(0.5 * angle)) /
                                             (angle * angle);
  LinearizedEdge linear;
  linear.e << error.translation, phi;
  linear.by_b.setZero();
  linear.by_b.topLeftCorner<3, 3>() = error.R();
  linear.by_b.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() + 0.5 * W + b * W * W;
  linear.by_a = -linear.by_b * T_a_b.inverse().adjoint();
  return linear;
}

Vector6d velocity_information(const BundleOptions& options) {
  Vector6d information;
  information << Eigen::Vector3d::Constant(std::pow(options.velocity_sigma_m_s, -2)),
      Eigen::Vector3d::Constant(std::pow(options.velocity_sigma_rad_s, -2));
  return information;
}

std::vector<int> free_sensor_parameters(const SensorCalibration& sensor) {
  std::vector<int> free;
  for (int i = 0; i < kSensorParameterCount; ++i) {
    if (sensor.prior_sigma(i) > 0) free.push_back(i);
  }
  return free;
}

double sensor_information(const SensorCalibration& sensor, int parameter) {
  const double sigma = sensor.prior_sigma(parameter);
  return std::isfinite(sigma) ? 1.0 / (sigma * sigma) : 0.0;
}

double bundle_cost(const BundleTask& task, const BundleState& state) {
  const HuberLoss loss{task.options.robust_width};
  const auto views = views_of(state);
  double cost = 0;
  for (size_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    const BundleObservation& o = task.problem.observations[i];
    const auto r =
        bundle_residual(task, o, task.uses[i], views[o.pose], state.p_world[o.point], state.sensor);
    cost += r.seen ? loss.rho(r.pixel_squared()) + loss.rho(r.depth_squared()) : loss.rho(kUnseenSquared);
  }
  for (const BundleEdge& edge : task.problem.edges) {
    const auto e = linearize_bundle_edge(edge, state.T_world_camera[edge.a], state.T_world_camera[edge.b]).e;
    cost += e.dot(edge.information * e);
  }
  const Vector6d velocity = velocity_information(task.options);
  for (size_t i = 0; i < state.velocities.size() && task.options.free_velocities; ++i) {
    cost += (state.velocities[i] - task.velocities[i]).cwiseAbs2().dot(velocity);
  }
  const SensorVector moved = state.sensor - task.problem.sensor.prior_mean;
  for (const int i : free_sensor_parameters(task.problem.sensor)) {
    cost += moved(i) * moved(i) * sensor_information(task.problem.sensor, i);
  }
  return cost;
}

}  // namespace kinloop
