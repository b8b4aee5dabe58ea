#pragma once
// A sensor as a value, which every estimator takes as one argument: the camera of camera.yaml, the noise of
// its measurements, and its deviations from that camera. Times are relative to the stamp of the colour image.

#include <optional>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/keypoint_measurement.hpp"
#include "kinloop/sensor/noise_model.hpp"
#include "kinloop/sensor/sensor_model.hpp"

namespace kinloop {

/// A camera with its noise and corrections.
struct Sensor {
  PinholeCamera camera = {};  ///< nominal: keypoints are undistorted with its lens
  NoiseModel noise = {};
  SensorVector corrections = SensorVector::Zero();  ///< deviation from `camera`; zero is an ideal sensor
};

/// Returns the sensor of camera.yaml: its corrections are the nominal times. Depth by structured light is
/// assumed to have the readout time of the colour image; that by time of flight or stereo is of one moment.
Sensor make_sensor(const RgbdCamera& camera, const NoiseOptions& noise = {});

/// Returns the sensor of motion-compensated measurements: the same camera and noise, without corrections.
Sensor without_corrections(Sensor sensor);

/// Projects the ray (x / z, y / z) with the corrected camera to undistorted pixels of the nominal one.
Eigen::Vector2d corrected_pixel(const Sensor& sensor, const Eigen::Vector2d& ray);

/// Returns the ray of an undistorted pixel in the corrected camera, the inverse of corrected_pixel.
Eigen::Vector2d corrected_ray(const Sensor& sensor, const Eigen::Vector2d& pixel);

/// Returns the monomials of the inverse depth bias at an undistorted pixel, in order of the parameters from
/// kInverseDepthBias.
Eigen::Matrix<double, 6, 1> inverse_depth_bias_basis(const PinholeCamera& camera,
                                                     const Eigen::Vector2d& pixel);

/// Returns the camera with the corrected focal length, principal point and distortion, by a fit over the
/// image. The fit error is below 0.1 px for small corrections.
PinholeCamera corrected_camera(const Sensor& sensor);

/// Returns when a row is exposed, s; `row` as in KeypointMeasurement.
double color_time_s(const Sensor& sensor, double row);

/// Returns when the depth of a keypoint was measured, s.
double depth_time_s(const Sensor& sensor, const KeypointMeasurement& measured);

/// Returns the raw pixel at which a moving camera sees a point given in camera axes at the frame's stamp.
/// nullopt if the point is behind the camera.
std::optional<Eigen::Vector2d> raw_pixel_of(const Sensor& sensor, const Eigen::Vector3d& p_camera,
                                            const Velocity& velocity);

}  // namespace kinloop
