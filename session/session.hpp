#pragma once
// Runs SLAM on a frame source and writes the results:
//
//   TumSource source(folder);
//   Session session(source);
//   session.run();
//   session.write_trajectory("trajectory.txt");
//   session.write_cloud("map.ply");

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dense/files/file_frame.hpp"
#include "dense/options.hpp"
#include "kinloop/core/progress.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/input/input_monitor.hpp"
#include "session/input/recording_advisor.hpp"
#include "session/source/frame_pipeline.hpp"
#include "session/store/dense_recorder.hpp"

namespace kinloop {

/// Returns the default options, with the final bundle adjustment on all CPUs.
SlamOptions default_slam_options();

struct SessionOptions {
  SlamOptions slam = default_slam_options();
  DenseOptions dense = {};
  bool record_images = true;  ///< keeps the images of keyframes; required for the cloud
  int threads = 0;            ///< for the cloud; 0 = all CPUs
};

/// Information in a map file about how it was made.
struct MapFileNotes {
  std::string input;                                         ///< empty: the name of the source
  std::string program;                                       ///< name and version
  std::vector<std::pair<std::string, std::string>> options;  ///< keys and values
};

/// The coloured cloud of a map and the frame of the file.
struct MapCloud {
  ColoredCloud cloud;
  UpEstimate up;
  FileFrame frame;  ///< z up
};

/// Runs SLAM from a source to the output files. Disables OpenCV threads for the whole process, so that the
/// result is the same on any machine; a session uses its own threads.
class Session {
 public:
  /// `source` must outlive this object.
  explicit Session(FrameSource& source, const SessionOptions& options = {});

  /// Uses `camera` instead of `source.camera()`, e.g. with another depth unit, and the given vocabulary
  /// instead of the default.
  Session(FrameSource& source, const SessionOptions& options, const RgbdCamera& camera,
          Vocabulary vocabulary);

  /// Continues a saved map. Call before the first frame. Returns the offset added to its frame ids. Restore
  /// its images separately (`recorder().restore`), with their frames shifted by the offset.
  uint32_t add_map(SavedMap saved) { return slam_.add_map(std::move(saved)); }

  /// `listener` must outlive this object.
  void add_listener(Listener& listener) { slam_.add_listener(listener); }

  /// Processes all remaining frames of the source, then calls `finish`. Rethrows errors of the source.
  const Trajectory& run(const Progress& progress = {});

  /// Returns the next frame, prepared ahead on another thread, or nothing at the end of the source.
  std::optional<Frame> next();

  /// Processes a frame returned by `next`. Call in order. Throws InputError if it is certain that nothing
  /// useful can come of such frames.
  TrackedFrame process(const Frame& frame) {
    track(frame);
    return update_map();
  }

  /// The two parts of `process`, see Slam: the pose as soon as it is known, then the map.
  TrackedFrame track(const Frame& frame);
  TrackedFrame update_map() { return slam_.update_map(); }

  /// Ends the run, also before the end of the source: adjusts the whole map and refines every frame.
  const Trajectory& finish(const Progress& progress = {});

  /// Returns the current poses of all located frames; doubtful ones only if asked for.
  [[nodiscard]] Trajectory trajectory(DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut) const {
    return slam_.trajectory(doubtful);
  }

  /// Returns the cloud of the current map. Waits for recorded images in flight.
  [[nodiscard]] MapCloud cloud(const Progress& progress = {});

  // Write output files: to a temporary file first, then renamed. Each throws InputError if it cannot be
  // written.

  void write_trajectory(const std::filesystem::path& path) const;  ///< TUM format, without doubtful poses
  void write_cloud(const std::filesystem::path& path);             ///< PLY, z up
  void write_map(const std::filesystem::path& path, const MapFileNotes& = {});  ///< can be continued later

  /// Returns where the input contradicts itself, complete after `finish`.
  [[nodiscard]] const InputMonitor& input() const { return input_; }
  /// Returns what spoils the recording.
  [[nodiscard]] const RecordingAdvisor& advisor() const { return advisor_; }
  [[nodiscard]] const Slam& slam() const { return slam_; }
  [[nodiscard]] DenseRecorder& recorder() { return recorder_; }
  [[nodiscard]] const DenseRecorder& recorder() const { return recorder_; }
  [[nodiscard]] const FrameSource& source() const { return source_; }
  [[nodiscard]] int threads() const { return threads_; }

 private:
  FrameSource& source_;
  int threads_;
  Slam slam_;
  DenseRecorder recorder_;
  InputMonitor input_;
  RecordingAdvisor advisor_;
  std::optional<FramePipeline> pipeline_;  // from the first frame to `finish`
  Trajectory trajectory_;                  // result of `finish`
};

}  // namespace kinloop
