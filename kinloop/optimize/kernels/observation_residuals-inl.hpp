// Residuals of several observations at once: the point moved to the time of its pixel row, projected by the
// corrected camera. Included once for each instruction set.

#include <cstddef>

#include "kinloop/optimize/kernels/observation_block.hpp"

#if defined(KINLOOP_OPTIMIZE_KERNELS_OBSERVATION_RESIDUALS_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef KINLOOP_OPTIMIZE_KERNELS_OBSERVATION_RESIDUALS_INL_HPP_
#undef KINLOOP_OPTIMIZE_KERNELS_OBSERVATION_RESIDUALS_INL_HPP_
#else
#define KINLOOP_OPTIMIZE_KERNELS_OBSERVATION_RESIDUALS_INL_HPP_
#endif

#include <hwy/highway.h>

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = ObservationBlock::Lanes;
using D = CappedLanes<double, ObservationBlock::kSize>;
using V = hn::Vec<D>;  // the same value of several observations
using Mask = hn::Mask<D>;

HWY_INLINE V all(double value) {
  return hn::Set(D(), value);
}

struct Vector3 {
  V x, y, z;

  // An implicit default constructor is not compiled for the instruction set, and gcc for ARM rejects it.
  HWY_INLINE Vector3() {}
  HWY_INLINE Vector3(V x_value, V y_value, V z_value) : x(x_value), y(y_value), z(z_value) {}
};
HWY_INLINE Vector3 all(const Eigen::Vector3d& v) {
  return {all(v.x()), all(v.y()), all(v.z())};
}
HWY_INLINE Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Vector3 operator-(const Vector3& a, const Vector3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Vector3 operator*(V factor, const Vector3& v) {
  return {factor * v.x, factor * v.y, factor * v.z};
}
HWY_INLINE V dot(const Vector3& a, const Vector3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The camera of the block.
struct Camera {
  V fx, fy, cx, cy, k1, k2;  // corrected
  Vector3 center, translation_rate, omega;
  Vector3 columns[3];  // columns of R_camera_world

  Camera(const BundleView& view, const Sensor& sensor)
      : fx(all(sensor.camera.fx + sensor.corrections(kFocalX))),
        fy(all(sensor.camera.fy + sensor.corrections(kFocalY))),
        cx(all(sensor.camera.cx + sensor.corrections(kCenterX))),
        cy(all(sensor.camera.cy + sensor.corrections(kCenterY))),
        k1(all(sensor.corrections(kRadial1))),
        k2(all(sensor.corrections(kRadial2))),
        center(all(view.center)),
        translation_rate(all(view.velocity.linear_m_s)),
        omega(all(view.velocity.angular_rad_s)) {
    for (int i = 0; i < 3; ++i) columns[i] = all(Eigen::Vector3d(view.R_camera_world.col(i)));
  }

  /// Returns the point in camera axes.
  HWY_INLINE Vector3 point(const Vector3& p_world) const {
    const Vector3 p = p_world - center;
    return p.x * columns[0] + p.y * columns[1] + p.z * columns[2];
  }
};

/// A point in camera axes, `dt` seconds after the stamp of its frame: p = E (p0 - nu dt), E = exp([phi]_x),
/// phi = -omega dt, by Rodrigues' formula: E v = v + phi x (a v + b phi x v).
struct MovedPoint {
  V dt, a, b;
  Vector3 phi, p;

  HWY_INLINE MovedPoint(const Camera& camera, const Vector3& p0, V dt_s)
      : dt(dt_s), phi(hn::Neg(dt_s) * camera.omega) {
    // Series of sin(t) / t and (1 - cos(t)) / t^2: exact for rotations up to 1 rad within a frame.
    const V t = dot(phi, phi), one = all(1);
    a = b = one;
    for (int n = 7; n > 0; --n) {
      a = one - t * all(1.0 / (2 * n * (2 * n + 1))) * a;
      b = one - t * all(1.0 / ((2 * n + 1) * (2 * n + 2))) * b;
    }
    b = all(0.5) * b;
    const Vector3 q = p0 - dt * camera.translation_rate;
    p = q + cross(phi, a * q + b * cross(phi, q));
  }

  HWY_INLINE Mask is_seen() const { return hn::Gt(p.z, all(kMinObservedDepth_m)); }
  HWY_INLINE Vector3 rotate_inverse(const Vector3& v) const {
    return v - cross(phi, a * v - b * cross(phi, v));
  }
};

/// Projection of a point by the corrected camera, with the terms shared by the derivatives.
struct Projection {
  V inverse_z, x, y, r2, bend, slope, u, v;

  HWY_INLINE Projection(const Camera& c, const Vector3& p) : inverse_z(all(1) / p.z) {
    x = p.x * inverse_z;
    y = p.y * inverse_z;
    r2 = x * x + y * y;
    bend = all(1) + r2 * (c.k1 + r2 * c.k2);
    slope = all(2) * (c.k1 + all(2) * r2 * c.k2);  // d bend / dx = x * slope
    u = c.fx * x * bend + c.cx;
    v = c.fy * y * bend + c.cy;
  }

  HWY_INLINE Vector3 u_by_point(const Camera& c) const {
    const V ux = c.fx * (bend + x * x * slope) * inverse_z, uy = c.fx * x * y * slope * inverse_z;
    return {ux, uy, hn::Neg(ux * x + uy * y)};
  }
  HWY_INLINE Vector3 v_by_point(const Camera& c) const {
    const V vx = c.fy * x * y * slope * inverse_z, vy = c.fy * (bend + y * y * slope) * inverse_z;
    return {vx, vy, hn::Neg(vx * x + vy * y)};
  }
};

/// Observations of the block in camera axes, with their residuals.
struct Observed {
  const Camera& camera;
  const Sensor& sensor;
  Vector3 p0;  // the point at the stamp of the frame
  V row, depth_stamp_difference, inverse_sigma_px, inverse_depth, gradient_x, gradient_y;
  Mask has_gradient, uses_pixel, uses_depth;
  V ray_x, ray_y;  // ray of the pixel in the nominal camera
  MovedPoint at_color;
  Projection color;
  MovedPoint at_depth;
  Projection depth;
  V inverse_sigma_depth;  // 1 / standard deviation of the inverse depth, see DepthNoise
  V error_u, error_v, error_depth;

  HWY_INLINE Observed(const ObservationBlock& block, size_t first, const Camera& c, const Sensor& s)
      : camera(c),
        sensor(s),
        p0(c.point({load(block.x, first), load(block.y, first), load(block.z, first)})),
        row(load(block.row, first)),
        depth_stamp_difference(load(block.depth_stamp_difference_s, first)),
        inverse_sigma_px(load(block.inverse_sigma_px, first)),
        inverse_depth(load(block.inverse_depth_per_m, first)),
        gradient_x(load(block.gradient_x, first)),
        gradient_y(load(block.gradient_y, first)),
        has_gradient(marked(block.has_gradient, first)),
        uses_pixel(marked(block.uses_pixel, first)),
        uses_depth(marked(block.uses_depth, first)),
        ray_x((load(block.pixel_x, first) - all(s.camera.cx)) / all(s.camera.fx)),
        ray_y((load(block.pixel_y, first) - all(s.camera.cy)) / all(s.camera.fy)),
        at_color(c, p0, color_time()),
        color(c, at_color.p),
        at_depth(c, p0, depth_time()),
        depth(c, at_depth.p) {
    const V pixel_x = load(block.pixel_x, first), pixel_y = load(block.pixel_y, first);
    error_u = (color.u - pixel_x) * inverse_sigma_px;
    error_v = (color.v - pixel_y) * inverse_sigma_px;
    V error = all(1 + s.corrections(kDepthScale)) * inverse_depth - depth.inverse_z + bias();
    // Depth is measured later than colour, when another surface point lies at the pixel.
    error = error + gradient_x * (depth.u - pixel_x) + gradient_y * (depth.v - pixel_y);
    const V share = all(s.noise.keypoint.crossover_m) * inverse_depth;
    inverse_sigma_depth = all(1) / (all(s.noise.keypoint.coefficient_per_m) * (all(1) + share * share));
    error_depth = error * inverse_sigma_depth;
  }

  static HWY_INLINE V load(const Lanes& lanes, size_t first) { return hn::LoadU(D(), &lanes[first]); }
  static HWY_INLINE Mask marked(const Lanes& lanes, size_t first) {
    return hn::Gt(load(lanes, first), hn::Zero(D()));
  }

  HWY_INLINE V color_time() const { return all(sensor.corrections(kRollingShutter)) * row; }
  /// For a surface of unknown gradient this motion is unknown. Assuming zero gradient would bias the delay
  /// towards zero, since most surfaces seen from above slope away from the camera.
  HWY_INLINE V depth_time() const {
    const V time = depth_stamp_difference + all(sensor.corrections(kDepthDelay)) +
                   all(sensor.corrections(kDepthShutter)) * row;
    return hn::IfThenElse(has_gradient, time, color_time());
  }
  /// Sum of inverse_depth_bias_basis times the parameters of the bias.
  HWY_INLINE V bias() const {
    const SensorVector& s = sensor.corrections;
    return all(s(kInverseDepthBias)) +
           ray_x * (all(s(kInverseDepthBiasX)) + ray_x * all(s(kInverseDepthBiasXX))) +
           ray_y * (all(s(kInverseDepthBiasY)) + ray_x * all(s(kInverseDepthBiasXY)) +
                    ray_y * all(s(kInverseDepthBiasYY)));
  }

  HWY_INLINE V pixel_squared() const { return error_u * error_u + error_v * error_v; }
  HWY_INLINE V depth_squared() const { return error_depth * error_depth; }
  /// Whether the point is in front of the camera at the colour time and, where `depth_matters`, at the depth
  /// time.
  HWY_INLINE Mask seen(Mask depth_matters) const {
    return hn::And(at_color.is_seen(), hn::Or(hn::Not(depth_matters), at_depth.is_seen()));
  }
};

/// Huber's loss, see HuberLoss.
struct Huber {
  V width, squared_width;

  explicit HWY_INLINE Huber(double w) : width(all(w)), squared_width(all(w * w)) {}

  HWY_INLINE V rho(V squared) const {
    const V linear = all(2) * width * hn::Sqrt(squared) - squared_width;
    return hn::IfThenElse(hn::Le(squared, squared_width), squared, linear);
  }
  HWY_INLINE V root_of_weight(V squared) const {
    return hn::IfThenElse(hn::Le(squared, squared_width), all(1), hn::Sqrt(width / hn::Sqrt(squared)));
  }
};

HWY_INLINE V cost_of(const Observed& o) {
  const Huber huber(o.sensor.noise.robust_width);
  const V of_depth = hn::IfThenElseZero(o.uses_depth, huber.rho(o.depth_squared()));
  const V cost = huber.rho(o.pixel_squared()) + of_depth;
  return hn::IfThenElseZero(o.uses_pixel,
                            hn::IfThenElse(o.seen(o.uses_depth), cost, huber.rho(all(kBehindCameraSquared))));
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
