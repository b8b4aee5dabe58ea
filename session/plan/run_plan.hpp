#pragma once
// In: what the user asked for. Out: what a run works with, decided once and before its first frame: the map
// to continue, the source, the camera, the options and the vocabulary.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/live/paced_source.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"
#include "session/plan/run_options.hpp"
#include "session/plan/sensor_memory.hpp"
#include "session/source/open_frame_source.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {

/// How a run works, whatever its source.
struct RunSettings {
  std::filesystem::path load_map;  ///< a map file to continue, or the folder of its run; empty: none
  bool localize = false;           ///< in that map, which does not change
  std::string vocabulary;          ///< a file; empty: the built-in
  int threads = 0;                 ///< 0: all
  int memory_mib = 0;              ///< 0: that of the options
  double budget_percent = 0;       ///< of one core, see work_level; 0: no limit
  bool no_loop = false;
  std::string solver;                    ///< of the pose graph; empty: that of the options
  std::vector<std::string> assignments;  ///< key=value
};

/// What does not depend on the source.
struct RunSetup {
  int threads = 1;
  std::optional<ContinuedMap> start;
  RunOptions options;
};

/// Opens the map to continue, whose features the frames must use, and applies the settings to the options,
/// which are not suited to the input yet. Throws UsageError or InputError with the remedy.
RunSetup set_up_run(const RunSettings& settings);

/// Returns the vocabulary in `file`, or the built-in one if that is empty. Throws UsageError if it does not
/// match the features.
Vocabulary open_vocabulary(const std::string& file, const FeatureOptions& features);

/// A source, and how a run works on it.
struct RunRequest {
  SourceRequest source;  ///< but for what `camera` and `settings` say of it
  CameraOptions camera;
  double pace_hz = 0;    ///< replays at this rate; 0: as fast as possible
  bool remember = true;  ///< what runs estimate of a live camera, see SensorMemory
  RunSettings settings;
};

struct RunPlan : RunSetup {
  std::unique_ptr<FrameSource> source;
  /// That of the source, with the times that are remembered of it, in the depth unit of the map to continue.
  RgbdCamera camera;
  std::optional<SensorMemory> memory;  ///< of the camera of the source, if it is to be used
  Vocabulary vocabulary;
  const PacedSource* paced = nullptr;  ///< part of `source`, if it is paced
  std::string depth_unit_guess = {};   ///< for users: that the unit of depth is guessed; empty: it is stated

  /// Returns how many frames came too fast.
  [[nodiscard]] size_t dropped() const { return paced != nullptr ? paced->dropped() : 0; }
};

/// Resolves what the user says of the recording, then the options, opens the source and suits the options to
/// it. Throws UsageError or InputError with the remedy.
RunPlan plan_run(const RunRequest& request);

}  // namespace kinloop
