#include "kinloop/slam/saved_session.hpp"

namespace kinloop {

std::vector<SavedFrame> saved_frames(const FrameLog& log) {
  std::vector<SavedFrame> saved;
  saved.reserve(log.size());
  for (const LoggedFrame& entry : log) {
    saved.push_back({entry.frame, entry.stamp_ns, static_cast<int>(entry.status), entry.reference,
                     entry.T_reference_camera, entry.keyframe, entry.repeat, entry.depth_stamp_difference_s});
  }
  return saved;
}

FrameLog logged_frames(const SavedMap& saved, uint32_t first_keyframe, uint32_t first_frame) {
  const auto shifted = [&](KeyframeId id) {
    return id.value < saved.map.keyframes.size() ? KeyframeId{id.value + first_keyframe} : KeyframeId{};
  };
  FrameLog log;
  log.reserve(saved.frames.size());
  for (const SavedFrame& frame : saved.frames) {
    LoggedFrame entry;
    entry.frame = FrameId{frame.frame.value + first_frame};
    entry.stamp_ns = frame.stamp_ns;
    entry.reference = shifted(frame.reference);
    entry.T_reference_camera = frame.T_reference_camera;
    entry.keyframe = shifted(frame.keyframe);
    entry.depth_stamp_difference_s = frame.depth_stamp_difference_s;
    entry.repeat = frame.repeat && !log.empty() && log.back().status != TrackStatus::kLost;
    const bool known = frame.status >= 0 && frame.status < static_cast<int>(TrackStatus::kLost);
    if (known && entry.reference.valid()) entry.status = static_cast<TrackStatus>(frame.status);
    log.push_back(std::move(entry));
  }
  return log;
}

std::vector<SavedParameter> saved_sensor(const SensorEstimate& estimate) {
  std::vector<SavedParameter> saved;
  for (int k = 0; k < kSensorParameterCount; ++k) {
    saved.push_back(
        {estimate.sensor.corrections(k), estimate.sigma(k), estimate.used[static_cast<size_t>(k)]});
  }
  return saved;
}

SensorEstimate sensor_estimate(const std::vector<SavedParameter>& saved, const Sensor& nominal) {
  SensorEstimate estimate = nominal_estimate(nominal);
  if (saved.size() != kSensorParameterCount) return estimate;
  for (int k = 0; k < kSensorParameterCount; ++k) {
    const auto& [value, sigma, used] = saved[static_cast<size_t>(k)];
    estimate.sensor.corrections(k) = value;
    estimate.sigma(k) = sigma;
    estimate.used[static_cast<size_t>(k)] = used;
  }
  return estimate;
}

}  // namespace kinloop
