#include "kinloop/slam/saved_session.hpp"

namespace kinloop {

FrameLog logged_frames(const SavedMap& saved, uint32_t first_keyframe, uint32_t first_frame) {
  const auto shifted = [&](KeyframeId id) {
    return id.value < saved.map.keyframes.size() ? KeyframeId{id.value + first_keyframe} : KeyframeId{};
  };
  FrameLog log;
  bool previous_lost = true;
  for (const FrameRecord& record : saved.frames) {
    LoggedFrame& frame = log.emplace_back();
    static_cast<FrameRecord&>(frame) = record;
    frame.id.value += first_frame;
    frame.reference = shifted(frame.reference);
    frame.keyframe = shifted(frame.keyframe);
    if (!frame.reference.valid()) frame.outcome = TrackingOutcome::kLost;
    if (frame.is_repeat() && previous_lost) frame.method = TrackingMethod::kKeypoints;
    previous_lost = frame.is_lost();
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
