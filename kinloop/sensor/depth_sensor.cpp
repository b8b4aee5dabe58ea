#include "kinloop/sensor/depth_sensor.hpp"

#include <array>

namespace kinloop {
namespace {

struct Preset {
  DepthSensorModel model;
  DepthSensorKind kind;
  double constant_m, coefficient_per_m;  ///< see DepthNoise::of
  double min_depth_m, max_depth_m;
  double typical_readout_s = 0, typical_readout_sigma_s = 0;
};

constexpr double kD435_per_m = 0.08 / (424 * 0.05);
constexpr double kFrameReadout_s = 0.03, kNarrow_s = 0.005, kWide_s = 0.01;

/// In the order of the enum.
constexpr std::array<Preset, 10> kPresets = {{
    {DepthSensorModel::kStructuredLight, DepthSensorKind::kStructuredLight, 0, kSensorInverseDepthSigmaPerM,
     0.4, 10},
    {DepthSensorModel::kTimeOfFlight, DepthSensorKind::kTimeOfFlight, 1e-3, 0.2e-3, 0.25, 10},
    {DepthSensorModel::kStereo, DepthSensorKind::kStereo, 0, kD435_per_m, 0.25, 10},
    {DepthSensorModel::kKinect1, DepthSensorKind::kStructuredLight, 0, kSensorInverseDepthSigmaPerM, 0.4, 10,
     kFrameReadout_s, kNarrow_s},
    {DepthSensorModel::kKinect2, DepthSensorKind::kTimeOfFlight, 1e-3, 0.2e-3, 0.5, 4.5, kFrameReadout_s,
     kWide_s},
    {DepthSensorModel::kAzureKinect, DepthSensorKind::kTimeOfFlight, 0.5e-3, 0.14e-3, 0.25, 5.5},
    {DepthSensorModel::kRealsenseD4xx, DepthSensorKind::kStereo, 0, kD435_per_m, 0.25, 6, kFrameReadout_s,
     kWide_s},
    {DepthSensorModel::kRealsenseL515, DepthSensorKind::kTimeOfFlight, 2.34e-3, 0.1625e-3, 0.25, 9},
    {DepthSensorModel::kIphone, DepthSensorKind::kTimeOfFlight, 5e-3, 1e-3, 0.25, 5},
    {DepthSensorModel::kHololens, DepthSensorKind::kTimeOfFlight, 2e-3, 0.6e-3, 0.25, 4},
}};

}  // namespace

DepthSensor depth_sensor(DepthSensorModel model, SensorOrigin origin) {
  const Preset& preset = kPresets[static_cast<size_t>(model)];
  const bool known = origin != SensorOrigin::kAssumed;
  return {model,
          preset.kind,
          DepthNoise::of(preset.constant_m, preset.coefficient_per_m),
          preset.min_depth_m,
          preset.max_depth_m,
          known ? preset.typical_readout_s : 0,
          known ? preset.typical_readout_sigma_s : 0,
          origin};
}

void DepthSensor::set_by_source(DepthSensorModel known) {
  if (origin != SensorOrigin::kCameraFile) *this = depth_sensor(known, SensorOrigin::kSource);
}

}  // namespace kinloop
