#pragma once
// From a source of frames to a map:
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

#include "kinloop/base/progress.hpp"
#include "kinloop/dense/options.hpp"
#include "kinloop/io/file_frame.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/dense_recorder.hpp"
#include "kinloop/slam/frame_pipeline.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {

/// The defaults, with the final bundle adjustment on all of the processor.
SlamOptions default_slam_options();

struct SessionOptions {
  SlamOptions slam = default_slam_options();
  DenseOptions dense = {};
  bool record_images = true;  ///< keeps images of keyframes; without them there is no cloud
  int threads = 0;            ///< for the cloud; 0 = all of the processor
};

/// What a map file says of how it was made.
struct MapFileNotes {
  std::string input;                                         ///< empty: the name of the source
  std::string program;                                       ///< name and version
  std::vector<std::pair<std::string, std::string>> options;  ///< keys and values
};

/// The coloured cloud of a map, and the frame to write it in.
struct MapCloud {
  ColoredCloud cloud;
  UpEstimate up;
  FileFrame frame;  ///< z up
};

/// A run from its source to its outputs. Turns the threads of OpenCV off for the whole process, so that the
/// result is the same on any machine: the threads of a session are its own.
class Session {
 public:
  /// `source` must outlive this object.
  explicit Session(FrameSource& source, const SessionOptions& options = {});

  /// The same for a camera other than `source.camera()`, e.g. with another unit of depth, and for another
  /// vocabulary than the default.
  Session(FrameSource& source, const SessionOptions& options, const RgbdCamera& camera,
          Vocabulary vocabulary);

  /// Goes on with a saved map; to be called before the first frame. Its images are restored apart from it
  /// (`recorder().restore`), their frames shifted by the result.
  uint32_t add_map(SavedMap saved) { return slam_.add_map(std::move(saved)); }

  /// `listener` must outlive this object.
  void add_listener(Listener& listener) { slam_.add_listener(listener); }

  /// All that is left to do: every frame of the source, then `finish`. Errors of the source are thrown here.
  const Trajectory& run(const Progress& progress = {});

  /// The next frame, prepared ahead on another thread; nothing at the end of the source.
  std::optional<PreparedFrame> next();

  /// Takes the frames that `next` gave, in order.
  FrameResult process(const PreparedFrame& frame) { return slam_.process(frame); }

  /// Ends the run, be it before the end of the source: adjusts the whole map and refines every frame.
  const Trajectory& finish(const Progress& progress = {});

  /// The poses of all located frames as they stand now.
  [[nodiscard]] Trajectory trajectory() const { return slam_.trajectory(); }

  /// The map as it stands now; waits for recorded images in flight.
  [[nodiscard]] MapCloud cloud(const Progress& progress = {});

  // Files, written beside and renamed. Each throws InputError where it cannot be written.

  void write_trajectory(const std::filesystem::path& path) const;               ///< TUM format
  void write_cloud(const std::filesystem::path& path);                          ///< PLY, z up
  void write_map(const std::filesystem::path& path, const MapFileNotes& = {});  ///< to go on with later

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
  std::optional<FramePipeline> pipeline_;  // from the first frame to `finish`
  Trajectory trajectory_;                  // what `finish` gave
};

}  // namespace kinloop
