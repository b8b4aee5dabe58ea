#include "kinloop/optimize/kernels/observation_block.hpp"

#include "kinloop/optimize/kernels/gram.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/optimize/kernels/observation_block.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
// after it
#include <hwy/highway.h>

#include "kinloop/base/highway_compat-inl.hpp"

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

  Camera(const BundleView& view, const MeasurementModel& model)
      : fx(all(model.camera.fx + model.sensor(kFocalX))),
        fy(all(model.camera.fy + model.sensor(kFocalY))),
        cx(all(model.camera.cx + model.sensor(kCenterX))),
        cy(all(model.camera.cy + model.sensor(kCenterY))),
        k1(all(model.sensor(kRadial1))),
        k2(all(model.sensor(kRadial2))),
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
  HWY_INLINE Vector3 turned_back(const Vector3& v) const { return v - cross(phi, a * v - b * cross(phi, v)); }
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
  const MeasurementModel& model;
  Vector3 p0;  // the point at the stamp of the frame
  V row, inverse_sigma_px, inverse_depth, gradient_x, gradient_y;
  Mask has_gradient, uses_pixel, uses_depth;
  V ray_x, ray_y;  // ray of the pixel in the nominal camera
  MovedPoint at_color;
  Projection color;
  MovedPoint at_depth;
  Projection depth;
  V error_u, error_v, error_depth;

  HWY_INLINE Observed(const ObservationBlock& block, size_t first, const Camera& c, const MeasurementModel& m)
      : camera(c),
        model(m),
        p0(c.point({load(block.x, first), load(block.y, first), load(block.z, first)})),
        row(load(block.row, first)),
        inverse_sigma_px(load(block.inverse_sigma_px, first)),
        inverse_depth(load(block.inverse_depth_per_m, first)),
        gradient_x(load(block.gradient_x, first)),
        gradient_y(load(block.gradient_y, first)),
        has_gradient(marked(block.has_gradient, first)),
        uses_pixel(marked(block.uses_pixel, first)),
        uses_depth(marked(block.uses_depth, first)),
        ray_x((load(block.pixel_x, first) - all(m.camera.cx)) / all(m.camera.fx)),
        ray_y((load(block.pixel_y, first) - all(m.camera.cy)) / all(m.camera.fy)),
        at_color(c, p0, color_time()),
        color(c, at_color.p),
        at_depth(c, p0, depth_time()),
        depth(c, at_depth.p) {
    const V pixel_x = load(block.pixel_x, first), pixel_y = load(block.pixel_y, first);
    error_u = (color.u - pixel_x) * inverse_sigma_px;
    error_v = (color.v - pixel_y) * inverse_sigma_px;
    V error = all(1 + m.sensor(kDepthScale)) * inverse_depth - depth.inverse_z + offset();
    // Depth is measured later than colour, when another surface point lies at the pixel.
    error = error + gradient_x * (depth.u - pixel_x) + gradient_y * (depth.v - pixel_y);
    error_depth = error * all(1 / m.inverse_depth_sigma_per_m);
  }

  static HWY_INLINE V load(const Lanes& lanes, size_t first) { return hn::LoadU(D(), &lanes[first]); }
  static HWY_INLINE Mask marked(const Lanes& lanes, size_t first) {
    return hn::Gt(load(lanes, first), hn::Zero(D()));
  }

  HWY_INLINE V color_time() const { return all(model.sensor(kRollingShutter)) * row; }
  /// For a surface of unknown gradient this motion is unknown. Assuming zero gradient would bias the delay
  /// towards zero, since most surfaces seen from above slope away from the camera.
  HWY_INLINE V depth_time() const {
    const V time = all(model.sensor(kDepthDelay)) + all(model.sensor(kDepthShutter)) * row;
    return hn::IfThenElse(has_gradient, time, color_time());
  }
  /// Sum of depth_offset_basis times the offset parameters.
  HWY_INLINE V offset() const {
    const SensorVector& s = model.sensor;
    return all(s(kDepthOffset)) + ray_x * (all(s(kDepthOffsetX)) + ray_x * all(s(kDepthOffsetXX))) +
           ray_y * (all(s(kDepthOffsetY)) + ray_x * all(s(kDepthOffsetXY)) + ray_y * all(s(kDepthOffsetYY)));
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
  const Huber huber(o.model.robust_width);
  const V of_depth = hn::IfThenElseZero(o.uses_depth, huber.rho(o.depth_squared()));
  const V cost = huber.rho(o.pixel_squared()) + of_depth;
  return hn::IfThenElseZero(o.uses_pixel,
                            hn::IfThenElse(o.seen(o.uses_depth), cost, huber.rho(all(kBehindCameraSquared))));
}

/// Stores values of several observations in rows, each observation by itself.
struct RowSink {
  const RowLayout& layout;
  double* rows;
  double* J_point;

  HWY_INLINE RowSink(const RowLayout& row_layout, size_t first, double* all_rows, double* all_J_point)
      : layout(row_layout),
        rows(all_rows + first * kRowsPerObservation * row_layout.width),
        J_point(all_J_point == nullptr ? nullptr : all_J_point + first * kRowsPerObservation * 3) {}

  static HWY_INLINE void scatter(double* to, size_t stride, V value) {
    HWY_ALIGN double lanes[ObservationBlock::kSize];
    hn::Store(value, D(), lanes);
    for (size_t lane = 0; lane < hn::Lanes(D()); ++lane)
      to[lane * kRowsPerObservation * stride] = lanes[lane];
  }
  [[nodiscard]] HWY_INLINE std::optional<size_t> velocity() const { return layout.velocity; }
  [[nodiscard]] HWY_INLINE bool has_sensor() const { return layout.sensor.has_value(); }
  [[nodiscard]] HWY_INLINE bool has_point() const { return J_point != nullptr; }
  HWY_INLINE void put(size_t row, size_t column, V value) const {
    scatter(rows + row * layout.width + column, layout.width, value);
  }
  HWY_INLINE void put_residual(size_t row, V value) const { put(row, layout.residual, value); }
  HWY_INLINE void put_sensor(size_t row, size_t parameter, V value) const {
    put(row, *layout.sensor + parameter, value);
  }
  HWY_INLINE void put_point(size_t row, size_t i, V value) const { scatter(J_point + row * 3 + i, 3, value); }
};

/// Stores values in columns over the observations of the block, without those of the point.
struct CameraColumnSink {
  const RowLayout& layout;
  double* columns;  // of the first observation

  [[nodiscard]] HWY_INLINE std::optional<size_t> velocity() const { return layout.velocity; }
  [[nodiscard]] HWY_INLINE bool has_sensor() const { return layout.sensor.has_value(); }
  [[nodiscard]] static HWY_INLINE bool has_point() { return false; }
  HWY_INLINE void put(size_t row, size_t column, V value) const {
    hn::StoreU(value, D(), columns + (row * layout.width + column) * ObservationBlock::kSize);
  }
  HWY_INLINE void put_residual(size_t row, V value) const { put(row, layout.residual, value); }
  HWY_INLINE void put_sensor(size_t row, size_t parameter, V value) const {
    put(row, *layout.sensor + parameter, value);
  }
  static HWY_INLINE void put_point(size_t, size_t, V) {}
};

/// Stores values in columns over the observations of the block.
struct BundleColumnSink {
  const BundleColumns& layout;
  double* columns;  // of the first observation

  [[nodiscard]] static HWY_INLINE std::optional<size_t> velocity() { return {}; }
  [[nodiscard]] HWY_INLINE bool has_sensor() const { return layout.sensor_count > 0; }
  [[nodiscard]] static HWY_INLINE bool has_point() { return true; }
  HWY_INLINE void put(size_t row, size_t column, V value) const {
    hn::StoreU(value, D(), columns + (row * layout.width() + column) * ObservationBlock::kSize);
  }
  HWY_INLINE void put_residual(size_t row, V value) const { put(row, BundleColumns::kResidual, value); }
  HWY_INLINE void put_sensor(size_t row, size_t parameter, V value) const {
    const int column = layout.of_sensor[parameter];
    if (column >= 0) put(row, static_cast<size_t>(column), value);
  }
  HWY_INLINE void put_point(size_t row, size_t i, V value) const { put(row, layout.point() + i, value); }
};

/// Writes residuals and derivatives of several observations.
template <class Sink>
class RowWriter {
 public:
  HWY_INLINE RowWriter(const Observed& o, const Sink& sink) : o_(o), sink_(sink) {}

  HWY_INLINE void write() {
    const Huber huber(o_.model.robust_width);
    const Mask pixel_counts = hn::And(o_.uses_pixel, o_.seen(o_.uses_depth));
    begin_row(0, pixel_counts, huber.root_of_weight(o_.pixel_squared()));
    write_pixel_row(o_.error_u, o_.color.u_by_point(o_.camera), kFocalX, o_.color.x, o_.camera.fx);
    row_ = 1;
    write_pixel_row(o_.error_v, o_.color.v_by_point(o_.camera), kFocalY, o_.color.y, o_.camera.fy);
    begin_row(2, hn::And(pixel_counts, o_.uses_depth), huber.root_of_weight(o_.depth_squared()));
    write_depth_row();
  }

 private:
  HWY_INLINE void begin_row(size_t row, Mask counts, V weight) {
    row_ = row;
    counts_ = counts;
    weight_ = weight;
  }

  HWY_INLINE V weighted(V value) const { return hn::IfThenElseZero(counts_, weight_ * value); }
  HWY_INLINE void put(size_t column, V value) const { sink_.put(row_, column, weighted(value)); }
  HWY_INLINE void put_sensor(int parameter, V value) const {
    sink_.put_sensor(row_, static_cast<size_t>(parameter), weighted(value));
  }
  HWY_INLINE void put(size_t column, const Vector3& value) const {
    put(column, value.x);
    put(column + 1, value.y);
    put(column + 2, value.z);
  }

  /// Writes the derivatives with respect to pose, velocity and point, given `a`, the derivative with respect
  /// to the moved point. Returns the derivative with respect to time.
  HWY_INLINE V write_motion(const Vector3& a, const MovedPoint& moved) const {
    const Vector3 b = moved.turned_back(a);
    put(0, all(-1) * b);
    put(3, cross(b, o_.p0));
    if (sink_.has_point()) {
      for (size_t i = 0; i < 3; ++i) sink_.put_point(row_, i, weighted(dot(b, o_.camera.columns[i])));
    }
    if (const auto velocity = sink_.velocity()) {
      // d exp(phi) = [J_l(phi) d phi]_x exp(phi); the angle within a frame is small, so a short series of J_l
      // suffices.
      const Vector3 turn = cross(a, moved.p), first = cross(turn, moved.phi),
                    second = cross(first, moved.phi);
      const Vector3 third = cross(second, moved.phi);
      put(*velocity, hn::Neg(moved.dt) * b);
      put(*velocity + 3,
          moved.dt * (turn + all(1.0 / 2) * first + all(1.0 / 6) * second + all(1.0 / 24) * third));
    }
    return hn::Neg(dot(a, cross(o_.camera.omega, moved.p)) + dot(b, o_.camera.translation_rate));
  }

  /// `along` is the x or y of the ray, `focal_length` and `focal` are the focal length and its parameter
  /// index on that axis.
  HWY_INLINE void write_pixel_row(V error, const Vector3& by_point, int focal, V along,
                                  V focal_length) const {
    const V scale = o_.inverse_sigma_px;
    const V by_time = write_motion(scale * by_point, o_.at_color);
    sink_.put_residual(row_, weighted(error));
    if (!sink_.has_sensor()) return;
    const V by_radial = focal_length * along * o_.color.r2 * scale;
    put_sensor(focal, along * o_.color.bend * scale);
    put_sensor(focal + kCenterX - kFocalX, scale);
    put_sensor(kRadial1, by_radial);
    put_sensor(kRadial2, by_radial * o_.color.r2);
    put_sensor(kRollingShutter, by_time * o_.row);
  }

  HWY_INLINE void write_depth_row() const {
    const Camera& c = o_.camera;
    const Projection& at = o_.depth;
    const V scale = all(1 / o_.model.inverse_depth_sigma_per_m), zero = hn::Zero(D());
    // Derivative of the residual with respect to the pixel.
    const V du = scale * o_.gradient_x, dv = scale * o_.gradient_y;
    const Vector3 by_point = du * at.u_by_point(c) + dv * at.v_by_point(c) +
                             Vector3{zero, zero, scale * at.inverse_z * at.inverse_z};
    const V by_time = write_motion(by_point, o_.at_depth);
    sink_.put_residual(row_, weighted(o_.error_depth));
    if (!sink_.has_sensor()) return;
    const V by_row_time = by_time * o_.row;
    const V by_radial = (du * c.fx * at.x + dv * c.fy * at.y) * at.r2;
    const V values[kSensorParameterCount] = {du * at.x * at.bend,
                                             dv * at.y * at.bend,
                                             du,
                                             dv,
                                             by_radial,
                                             by_radial * at.r2,
                                             hn::IfThenZeroElse(o_.has_gradient, by_row_time),
                                             hn::IfThenElseZero(o_.has_gradient, by_time),
                                             hn::IfThenElseZero(o_.has_gradient, by_row_time),
                                             scale * o_.inverse_depth,
                                             scale,
                                             scale * o_.ray_x,
                                             scale * o_.ray_y,
                                             scale * o_.ray_x * o_.ray_x,
                                             scale * o_.ray_x * o_.ray_y,
                                             scale * o_.ray_y * o_.ray_y};
    for (int i = 0; i < kSensorParameterCount; ++i) put_sensor(i, values[i]);
  }

  const Observed& o_;
  const Sink& sink_;
  size_t row_ = 0;
  Mask counts_;
  V weight_;
};

/// Calls `use` with successive groups of observations that fill a vector, and the index of the first.
template <class Use>
HWY_INLINE void for_lanes(const ObservationBlock& block, const BundleView& view,
                          const MeasurementModel& model, const Use& use) {
  const Camera camera(view, model);
  for (size_t first = 0; first < ObservationBlock::kSize; first += hn::Lanes(D())) {
    use(Observed(block, first, camera, model), first);
  }
}

void residuals(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
               BlockResiduals& result) {
  for_lanes(block, view, model, [&](const Observed& o, size_t first) HWY_ATTR {
    const Mask has_depth = hn::Gt(o.inverse_depth, hn::Zero(D()));
    hn::StoreU(o.error_u, D(), &result.u[first]);
    hn::StoreU(o.error_v, D(), &result.v[first]);
    hn::StoreU(hn::IfThenElseZero(has_depth, o.error_depth), D(), &result.depth[first]);
    hn::StoreU(hn::IfThenElseZero(o.seen(has_depth), all(1)), D(), &result.seen[first]);
  });
}

void cost(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
          Lanes& result) {
  for_lanes(block, view, model,
            [&](const Observed& o, size_t first) HWY_ATTR { hn::StoreU(cost_of(o), D(), &result[first]); });
}

void linearize(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
               const RowLayout& layout, double* rows, double* J_point, Lanes& result) {
  for_lanes(block, view, model, [&](const Observed& o, size_t first) HWY_ATTR {
    const RowSink sink(layout, first, rows, J_point);
    RowWriter<RowSink>(o, sink).write();
    hn::StoreU(cost_of(o), D(), &result[first]);
  });
}

void linearize_bundle(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
                      const BundleColumns& layout, double* columns) {
  for_lanes(block, view, model, [&](const Observed& o, size_t first) HWY_ATTR {
    const BundleColumnSink sink{layout, columns + first};
    RowWriter<BundleColumnSink>(o, sink).write();
  });
}

void linearize_camera(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
                      const RowLayout& layout, double* columns, Lanes& result) {
  for_lanes(block, view, model, [&](const Observed& o, size_t first) HWY_ATTR {
    const CameraColumnSink sink{layout, columns + first};
    RowWriter<CameraColumnSink>(o, sink).write();
    hn::StoreU(cost_of(o), D(), &result[first]);
  });
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(residuals);
HWY_EXPORT(cost);
HWY_EXPORT(linearize);
HWY_EXPORT(linearize_bundle);
HWY_EXPORT(linearize_camera);

}  // namespace

RowLayout::RowLayout(bool with_velocity, bool with_sensor) {
  size_t next = 6;
  if (with_velocity) {
    velocity = next;
    next += 6;
  }
  if (with_sensor) {
    sensor = next;
    next += kSensorParameterCount;
  }
  residual = next++;
  width = (next + kWidthStep - 1) / kWidthStep * kWidthStep;
}

BlockResiduals block_residuals(const ObservationBlock& block, const BundleView& view,
                               const MeasurementModel& model) {
  BlockResiduals result;
  HWY_DYNAMIC_DISPATCH(residuals)(block, view, model, result);
  return result;
}

ObservationBlock::Lanes block_cost(const ObservationBlock& block, const BundleView& view,
                                   const MeasurementModel& model) {
  ObservationBlock::Lanes result;
  HWY_DYNAMIC_DISPATCH(cost)(block, view, model, result);
  return result;
}

ObservationBlock::Lanes linearize_block(const ObservationBlock& block, const BundleView& view,
                                        const MeasurementModel& model, const RowLayout& layout, double* rows,
                                        double* J_point) {
  ObservationBlock::Lanes result;
  HWY_DYNAMIC_DISPATCH(linearize)(block, view, model, layout, rows, J_point, result);
  return result;
}

void linearize_block(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
                     const BundleColumns& layout, double* columns) {
  HWY_DYNAMIC_DISPATCH(linearize_bundle)(block, view, model, layout, columns);
}

ObservationBlock::Lanes linearize_in_columns(const ObservationBlock& block, const BundleView& view,
                                             const MeasurementModel& model, const RowLayout& layout,
                                             double* columns) {
  ObservationBlock::Lanes result;
  HWY_DYNAMIC_DISPATCH(linearize_camera)(block, view, model, layout, columns, result);
  return result;
}

BundleColumns::BundleColumns(const SensorVector& prior_sigma) {
  of_sensor.fill(-1);
  const auto add = [&](int parameter) {
    if (!(prior_sigma(parameter) > 0)) return;
    of_sensor[static_cast<size_t>(parameter)] = static_cast<int>(kSensor + sensor_count);
    sensor_parameters[sensor_count++] = parameter;
  };
  for (int k = 0; k <= kRollingShutter; ++k) add(k);
  pixel_end = kSensor + sensor_count;
  for (int k = kDepthDelay; k < kSensorParameterCount; ++k) add(k);
}

}  // namespace kinloop
#endif
