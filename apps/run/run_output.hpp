#pragma once
// In: a session and its listeners' records. Out: the files of the run: the map while it grows, all results at
// its end.

#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/run/frame_recorder.hpp"
#include "apps/run/run_arguments.hpp"
#include "apps/run/summary/run_summary.hpp"
#include "apps/run/summary/run_warnings.hpp"
#include "kinloop/core/files/file_lock.hpp"
#include "session/session.hpp"
#include "session/store/map_store.hpp"
#include "session/store/run_files.hpp"

namespace kinloop {

/// How the frames of a run ended, and when.
struct RunEnding {
  Stopwatch since_start;  ///< of the program
  ElapsedTime startup;    ///< from there to the first frame
  bool complete = false;  ///< neither interrupted nor ended by a failing source
};

/// Writes the files of a run. With --localize but without --report they are the trajectory, the frame table
/// and run.json alone.
class RunOutput {
 public:
  /// Listens to the session, which must outlive this object, as must `plan`. Throws InputError or UsageError
  /// if a file cannot be written.
  RunOutput(const RunArguments& arguments, const RunPlan& plan, Session& session);
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  /// Records the pose of a frame as it is given. Call for each frame before it is mapped.
  void record_pose(const TrackedFrame& tracked) { frames_.record_pose(tracked); }

  /// Saves the map file if it is due, see MapSaver.
  void save_if_due();

  /// Saves the map file, if there is to be one. Logs a failure and returns false.
  bool try_save_map_file();

  /// Writes trajectory, cloud and map file as they are now.
  void save_now();

  /// Saves the map file and writes all results, then run.json, which includes the time of that, and the
  /// report. Returns the content of run.json. Throws InputError if a file cannot be written.
  nlohmann::json write(const RunEnding& ending, const Progress& progress);

  /// After `write`: warns of problems, see check_result; returns false if the results are of no use or the
  /// map file could not be saved.
  [[nodiscard]] bool check() const;

  /// Returns the file that says most about the run.
  [[nodiscard]] std::filesystem::path details() const {
    return poses_only_ ? folder_.frames() : folder_.report();
  }

  [[nodiscard]] const RunFolder& folder() const { return folder_; }
  [[nodiscard]] bool poses_only() const { return poses_only_; }

 private:
  [[nodiscard]] Trajectory trajectory() const { return session_.trajectory(doubtful_); }
  [[nodiscard]] TrajectoryCovariances covariances() const;
  [[nodiscard]] std::string trajectory_note() const;
  void write_trajectory() const;
  void write_trajectory_copy() const;
  [[nodiscard]] MapCloud cloud(const Progress& progress);
  [[nodiscard]] nlohmann::json summary() const;
  void write_results() const;
  void write_mask() const;

  RunFolder folder_;
  std::string frame_;  // of the cloud
  bool poses_only_;
  std::filesystem::path trajectory_copy_;
  DoubtfulPoses doubtful_;  // in trajectory.txt
  const RunPlan& plan_;
  Session& session_;
  FrameRecorder frames_;
  DepthMonitor depth_;
  std::optional<FileLock> map_lock_;  // of the file that saver_ writes
  std::unique_ptr<MapSaver> saver_;   // null: the map is not saved
  bool saved_ = true;
  std::optional<MapCloud> map_;
  RunOutcome outcome_;
};

}  // namespace kinloop
