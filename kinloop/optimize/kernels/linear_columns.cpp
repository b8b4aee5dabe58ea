#include "kinloop/optimize/kernels/linear_columns.hpp"

namespace kinloop {

LinearColumns::LinearColumns(bool with_velocity, const SensorVector& prior_sigma, bool with_point) {
  used = kResidual + 1;
  if (with_velocity) {
    velocity = used;
    used += 6;
  }
  of_sensor.fill(-1);
  const auto add_sensor = [&](int begin, int end) {
    for (int parameter = begin; parameter < end; ++parameter) {
      if (!(prior_sigma(parameter) > 0)) continue;
      of_sensor[static_cast<size_t>(parameter)] = static_cast<int>(used++);
      sensor_parameters[sensor_count++] = parameter;
    }
  };
  add_sensor(0, kDepthDelay);
  pixel_end = used;
  add_sensor(kDepthDelay, kSensorParameterCount);
  if (with_point) point = used;
  width = used + 3;
}

LinearColumns LinearColumns::of_pose() {
  return {false, SensorVector::Zero(), false};
}
LinearColumns LinearColumns::of_pose_and_velocity() {
  return {true, SensorVector::Zero(), false};
}
LinearColumns LinearColumns::of_bundle(const SensorVector& prior_sigma) {
  return {false, prior_sigma, true};
}
LinearColumns LinearColumns::of_all() {
  return {true, SensorVector::Ones(), true};
}

}  // namespace kinloop
