#include "kinloop/optimize/kernels/observation_block.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/optimize/kernels/observation_block.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
// after it
#include <hwy/highway.h>

#include "kinloop/core/highway_compat-inl.hpp"
#include "kinloop/optimize/kernels/observation_residuals-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

/// Writes residuals and derivatives of several observations to their columns.
class ColumnWriter {
 public:
  /// `columns` are those of the first observation.
  HWY_INLINE ColumnWriter(const Observed& o, const LinearColumns& layout, double* columns)
      : o_(o), layout_(layout), columns_(columns) {}

  HWY_INLINE void write() {
    const Huber huber(o_.sensor.noise.robust_width);
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
  HWY_INLINE void put(size_t column, V value) const {
    double* to = columns_ + (row_ * layout_.width + column) * ObservationBlock::kSize;
    hn::StoreU(weighted(value), D(), to);
  }
  HWY_INLINE void put_sensor(int parameter, V value) const {
    const int column = layout_.of_sensor[static_cast<size_t>(parameter)];
    if (column >= 0) put(static_cast<size_t>(column), value);
  }
  HWY_INLINE void put(size_t column, const Vector3& value) const {
    put(column, value.x);
    put(column + 1, value.y);
    put(column + 2, value.z);
  }

  /// Writes the derivatives with respect to pose, velocity and point, given `a`, the derivative with respect
  /// to the moved point. Returns the derivative with respect to time.
  HWY_INLINE V write_motion(const Vector3& a, const MovedPoint& moved) const {
    const Vector3 b = moved.rotate_inverse(a);
    put(0, all(-1) * b);
    put(3, cross(b, o_.p0));
    if (layout_.point) {
      for (size_t i = 0; i < 3; ++i) put(*layout_.point + i, dot(b, o_.camera.columns[i]));
    }
    if (layout_.velocity) {
      // d exp(phi) = [J_l(phi) d phi]_x exp(phi); the angle within a frame is small, so a short series of J_l
      // suffices.
      const Vector3 turn = cross(a, moved.p), first = cross(turn, moved.phi),
                    second = cross(first, moved.phi);
      const Vector3 third = cross(second, moved.phi);
      put(*layout_.velocity, hn::Neg(moved.dt) * b);
      put(*layout_.velocity + 3,
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
    put(LinearColumns::kResidual, error);
    if (layout_.sensor_count == 0) return;
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
    const V scale = o_.inverse_sigma_depth, zero = hn::Zero(D());
    // Derivative of the residual with respect to the pixel.
    const V du = scale * o_.gradient_x, dv = scale * o_.gradient_y;
    const Vector3 by_point = du * at.u_by_point(c) + dv * at.v_by_point(c) +
                             Vector3{zero, zero, scale * at.inverse_z * at.inverse_z};
    const V by_time = write_motion(by_point, o_.at_depth);
    put(LinearColumns::kResidual, o_.error_depth);
    if (layout_.sensor_count == 0) return;
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
  const LinearColumns& layout_;
  double* columns_;
  size_t row_ = 0;
  Mask counts_;
  V weight_;
};

/// Calls `use` with successive groups of observations that fill a vector, and the index of the first.
template <class Use>
HWY_INLINE void for_lanes(const ObservationBlock& block, const BundleView& view, const Sensor& sensor,
                          const Use& use) {
  const Camera camera(view, sensor);
  for (size_t first = 0; first < ObservationBlock::kSize; first += hn::Lanes(D())) {
    use(Observed(block, first, camera, sensor), first);
  }
}

void residuals(const ObservationBlock& block, const BundleView& view, const Sensor& sensor,
               BlockResiduals& result) {
  for_lanes(block, view, sensor, [&](const Observed& o, size_t first) HWY_ATTR {
    const Mask has_depth = hn::Gt(o.inverse_depth, hn::Zero(D()));
    hn::StoreU(o.error_u, D(), &result.u[first]);
    hn::StoreU(o.error_v, D(), &result.v[first]);
    hn::StoreU(hn::IfThenElseZero(has_depth, o.error_depth), D(), &result.depth[first]);
    hn::StoreU(hn::IfThenElseZero(o.seen(has_depth), all(1)), D(), &result.seen[first]);
  });
}

void cost(const ObservationBlock& block, const BundleView& view, const Sensor& sensor, Lanes& result) {
  for_lanes(block, view, sensor,
            [&](const Observed& o, size_t first) HWY_ATTR { hn::StoreU(cost_of(o), D(), &result[first]); });
}

Lanes linearize(const ObservationBlock& block, const BundleView& view, const Sensor& sensor,
                const LinearColumns& layout, double* columns) {
  Lanes result;
  for_lanes(block, view, sensor, [&](const Observed& o, size_t first) HWY_ATTR {
    ColumnWriter(o, layout, columns + first).write();
    hn::StoreU(cost_of(o), D(), &result[first]);
  });
  return result;
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

}  // namespace

BlockResiduals block_residuals(const ObservationBlock& block, const BundleView& view, const Sensor& sensor) {
  BlockResiduals result;
  HWY_DYNAMIC_DISPATCH(residuals)(block, view, sensor, result);
  return result;
}

ObservationBlock::Lanes block_cost(const ObservationBlock& block, const BundleView& view,
                                   const Sensor& sensor) {
  ObservationBlock::Lanes result;
  HWY_DYNAMIC_DISPATCH(cost)(block, view, sensor, result);
  return result;
}

ObservationBlock::Lanes linearize_block(const ObservationBlock& block, const BundleView& view,
                                        const Sensor& sensor, const LinearColumns& layout, double* columns) {
  return HWY_DYNAMIC_DISPATCH(linearize)(block, view, sensor, layout, columns);
}

}  // namespace kinloop
#endif
