#pragma once
// In: the frames of a run. Out: the rows of frames.txt, and the poses of live.txt.

#include <span>
#include <vector>

#include "kinloop/core/timings.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "tools/evaluation/consistency.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {

/// Returns the status of a frame as frames.txt has it: tracked, dense, predicted, doubtful or lost.
const char* frame_status(const FrameRecord& tracked);

/// Makes a row per frame for frames.txt. All but its features are from the log at the end of the run, so that
/// they agree with trajectory.txt: frames that were lost may have been found since.
class FrameRecorder : public Listener {
 public:
  /// Covariances, which are most of the memory, are only compared with a ground truth.
  explicit FrameRecorder(bool with_covariances = true) : with_covariances_(with_covariances) {}

  /// Records the pose of a frame as it is given, before the frame is mapped. Call for each frame.
  void record_pose(const TrackedFrame& tracked);

  void on_frame(const TrackedFrame& tracked) override;
  void on_map(const Map& /*map*/) override {}

  /// Returns the rows, with the time of each frame. `log` has the same frames.
  [[nodiscard]] FrameTable table(std::span<const LoggedFrame> log, const Timings& times) const;

  /// Returns the time from when the images of a frame were there to its pose, ms, for each frame of which it
  /// is known.
  [[nodiscard]] const std::vector<double>& latencies_ms() const { return latencies_ms_; }

  /// Returns the time from the stamp of each image to its pose, ms, by the time of day; meaningless for
  /// recordings.
  [[nodiscard]] const std::vector<double>& ages_ms() const { return ages_ms_; }

  /// Returns the poses that tracking gave, each in the map as it was then, with their covariances, which are
  /// zero if they were not recorded. Frames that were lost or doubtful are left out, and those that were in
  /// other components than the main one then, whose world frames are their own. `log` has the same frames.
  [[nodiscard]] std::vector<PoseWithCovariance> live_poses(std::span<const LoggedFrame> log,
                                                           const Map& map) const;

 private:
  /// A pose as tracking gave it.
  struct GivenPose {
    size_t frame;        // index in the log
    uint32_t component;  // in which it was then
    StampedPose pose;
  };

  std::vector<int> feature_counts_;  // the log drops the features
  std::vector<double> latencies_ms_, ages_ms_;
  bool with_covariances_;
  std::vector<GivenPose> live_poses_;
  std::vector<Matrix6d> covariances_;  // of live_poses_, or none
};

}  // namespace kinloop
