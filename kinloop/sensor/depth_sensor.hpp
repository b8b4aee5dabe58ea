#pragma once
// Kinds of depth sensor and presets: the noise of depth and the usable range. docs/cameras.md lists the
// figures.

#include "kinloop/core/options.hpp"
#include "kinloop/sensor/depth_noise.hpp"

namespace kinloop {

/// How depth is measured.
enum class DepthSensorKind { kStructuredLight, kTimeOfFlight, kStereo };

constexpr auto option_names(DepthSensorKind) {
  return std::to_array<EnumName<DepthSensorKind>>({{DepthSensorKind::kStructuredLight, "structured_light"},
                                                   {DepthSensorKind::kTimeOfFlight, "time_of_flight"},
                                                   {DepthSensorKind::kStereo, "stereo"}});
}

/// What `sensor` in camera.yaml may name: a sensor, or only a kind, which stands for a typical sensor of the
/// kind. Map files store the number: append only.
enum class DepthSensorModel {
  kStructuredLight,
  kTimeOfFlight,
  kStereo,
  kKinect1,
  kKinect2,
  kAzureKinect,
  kRealsenseD4xx,
  kRealsenseL515,
  kIphone,
  kHololens,
};

constexpr auto option_names(DepthSensorModel) {
  return std::to_array<EnumName<DepthSensorModel>>({{DepthSensorModel::kStructuredLight, "structured_light"},
                                                    {DepthSensorModel::kTimeOfFlight, "time_of_flight"},
                                                    {DepthSensorModel::kStereo, "stereo"},
                                                    {DepthSensorModel::kKinect1, "kinect1"},
                                                    {DepthSensorModel::kKinect2, "kinect2"},
                                                    {DepthSensorModel::kAzureKinect, "azure_kinect"},
                                                    {DepthSensorModel::kRealsenseD4xx, "realsense_d4xx"},
                                                    {DepthSensorModel::kRealsenseL515, "realsense_l515"},
                                                    {DepthSensorModel::kIphone, "iphone"},
                                                    {DepthSensorModel::kHololens, "hololens"}});
}

/// Who named the sensor; a later one overrides an earlier one.
enum class SensorOrigin { kAssumed, kSource, kCameraFile };

/// A depth sensor as plain data; by default a Kinect 1, which is assumed where nothing is known.
struct DepthSensor {
  DepthSensorModel model = DepthSensorModel::kKinect1;
  DepthSensorKind kind = DepthSensorKind::kStructuredLight;
  DepthNoise noise = {};  ///< on planes
  /// Depth outside this range is not used in dense maps.
  double min_depth_m = 0.4, max_depth_m = 10;
  /// Readout time of the colour image, first row to last, at 30 Hz, with its spread (1 sigma); 0 if unknown.
  double typical_readout_s = 0, typical_readout_sigma_s = 0;
  SensorOrigin origin = SensorOrigin::kAssumed;

  /// Makes this the sensor that a driver or reader knows, unless the camera file names one.
  void set_by_source(DepthSensorModel known);
};

/// Returns the preset.
///
/// - kinect1: Khoshelham and Elberink 2012, "Accuracy and resolution of Kinect depth data".
/// - kinect2: fitted to Fankhauser et al. 2015, "Kinect v2 for mobile robot navigation: evaluation and
///   modeling", head-on.
/// - azure_kinect: fitted to Toelgyessy et al. 2021, "Evaluation of the Azure Kinect and its comparison to
///   Kinect v1 and Kinect v2", mode NFOV unbinned; range of the data sheet.
/// - realsense_d4xx: Intel's "Tuning depth cameras for best performance": disparity noise of 0.08 px, over
///   the focal length (424 px) times the baseline (50 mm) of a D435 of 848 x 480 pixels.
/// - realsense_l515: Intel's data sheet: at most 2.5 mm at 1 m and 15.5 mm at 9 m.
/// - iphone, hololens: estimates; no measured law of the depth that their software delivers is known.
///
/// The typical readout is 30 ms for colour cameras whose rolling shutter fills the time of an image.
/// Self-calibration finds 25 to 31 ms in recordings of the Kinect 1. The others spread more: a D4xx may be a
/// D455, which has a global shutter. It is unknown unless a source or the camera file names the sensor.
DepthSensor depth_sensor(DepthSensorModel model, SensorOrigin origin);

// The error that all depths of a sensor have in common.

/// Returns the standard deviation of the scale of depth, relative. Time-of-flight cameras also receive light
/// that was reflected more than once, which makes rooms larger or smaller by up to 0.5 %. Learned on
/// simulated rooms 106 and 109.
constexpr double depth_scale_sigma(DepthSensorKind kind) {
  return kind == DepthSensorKind::kTimeOfFlight ? 0.003 : 0;
}

}  // namespace kinloop
