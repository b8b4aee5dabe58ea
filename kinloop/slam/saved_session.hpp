#pragma once
// Conversion between the frames and sensor estimate of a run and their form in a map file.

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/saved_map.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

/// Returns the log of a saved map with keyframe and frame ids shifted past the existing ones. The file does
/// not hold the observations of frames. A frame whose keyframe is missing counts as lost.
FrameLog logged_frames(const SavedMap& saved, uint32_t first_keyframe, uint32_t first_frame);

std::vector<SavedParameter> saved_sensor(const SensorEstimate& estimate);

/// Returns the saved estimate; where there is none, that of `nominal`, the sensor of camera.yaml.
SensorEstimate sensor_estimate(const std::vector<SavedParameter>& saved, const Sensor& nominal);

}  // namespace kinloop
