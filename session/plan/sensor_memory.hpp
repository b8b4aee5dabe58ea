#pragma once
// In: what runs estimate of the times of a live camera. Out: where the next run with that camera begins. One
// file for each serial number; recordings are never remembered, so that their results can be reproduced.

#include <filesystem>
#include <optional>
#include <string>

#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// A time that was estimated: its value and standard deviation, s.
struct EstimatedTime {
  double value_s = 0;
  double sigma_s = 0;
};

/// What is remembered of a camera in one mode.
struct RememberedSensor {
  int width = 0, height = 0;  ///< of the colour image
  double fps = 0;
  int runs = 0;  ///< that contributed
  /// As in RgbdCamera; none if no run could estimate it.
  std::optional<EstimatedTime> rolling_shutter, depth_delay;
};

/// Returns `before` with the estimates of another run, weighted by their variances; the variance of what was
/// known before is doubled, since it may have changed. What is known of another mode of the camera is
/// dropped. nullopt if the run has estimated no time.
std::optional<RememberedSensor> merged(const RememberedSensor& before, const RgbdCamera& camera,
                                       const SensorEstimate& estimate);

/// Returns the folder of the files: kinloop/sensors in XDG_DATA_HOME, or in ~/.local/share; empty if neither
/// is known.
std::filesystem::path sensor_memory_folder();

/// The file of one camera. What is wrong with it is logged, and never ends a run.
class SensorMemory {
 public:
  /// `serial` names the file; characters that names of files should not have become `_`.
  SensorMemory(const std::filesystem::path& folder, const std::string& serial);

  /// Returns the camera with the remembered times that its calibration does not state, and logs them.
  [[nodiscard]] RgbdCamera recall(RgbdCamera camera) const;

  /// Merges the estimate of a run with `camera` into the file.
  void remember(const RgbdCamera& camera, const SensorEstimate& estimate) const;

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  [[nodiscard]] RememberedSensor read() const;

  std::string serial_;
  std::filesystem::path file_;
};

/// Returns the memory of the camera behind a source; nullopt for recordings, and for cameras without a serial
/// number.
std::optional<SensorMemory> sensor_memory_of(const SourceInfo& info);

}  // namespace kinloop
