#pragma once
// What a map file keeps of frames and sensor, and back.

#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/slam/self_calibration.hpp"

namespace kinloop {

std::vector<SavedFrame> saved_frames(const FrameLog& log);

/// The log of a saved map whose keyframes and frames shift by what is there before them. What its frames saw
/// is not known any more, and a frame whose keyframe is missing counts as lost.
FrameLog logged_frames(const SavedMap& saved, uint32_t first_keyframe, uint32_t first_frame);

std::vector<SavedParameter> saved_sensor(const SensorEstimate& sensor);

/// The estimate that was saved; where there is none, `known`.
SensorEstimate sensor_estimate(const std::vector<SavedParameter>& saved, const SensorVector& known);

}  // namespace kinloop
