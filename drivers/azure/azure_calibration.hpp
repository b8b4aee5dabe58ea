#pragma once
// In: calibration.json of an Azure Kinect or Femto recording. Out: its cameras in the modes of the recording.

#include <string>

#include <opencv2/core/types.hpp>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

struct AzureCalibration {
  PinholeCamera color, depth;
  SE3 T_color_depth;
};

/// Returns the factory calibration for images of these sizes; the sensor's mode follows from the size. Throws
/// InputError for anything that is not such a calibration, and for sizes that no mode has.
AzureCalibration read_azure_calibration(const std::string& json, cv::Size color, cv::Size depth);

}  // namespace kinloop
