#pragma once
// A run in Python: SLAM, the images for its dense map, and what is needed to save it.

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "dense/files/file_frame.hpp"
#include "dense/texture/texture_mesh.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "kinloop/slam/slam.hpp"
#include "python/bindings/source.hpp"
#include "session/input/input_monitor.hpp"
#include "session/plan/run_plan.hpp"
#include "session/store/dense_recorder.hpp"

namespace kinloop::python {

/// A frame as arrays, of which `color` holds its own pixels.
struct ArrayFrame {
  int64_t stamp_ns = 0;
  std::optional<int64_t> depth_stamp_ns;
  ColorImage color;
  cv::Mat depth_m;    ///< as measured
  cv::Mat mask = {};  ///< 8UC1, 0 = to be ignored; empty: all is used
};

/// Its functions may be called from several threads, without the GIL.
class Run {
 public:
  Run(const RgbdCamera& camera, const RunSettings& settings);

  /// Tracks a PyFrame or ArrayFrame. Throws UsageError for images of another size than the camera's, and
  /// after `finish`.
  template <class Given>
  TrackedFrame track(const Given& given) {
    const std::lock_guard lock(mutex_);
    return track_next(prepared(given));
  }
  /// Maps the frame of the last `track`. Throws UsageError if there is none.
  TrackedFrame update_map();
  /// Does both.
  template <class Given>
  TrackedFrame process(const Given& given) {
    const std::lock_guard lock(mutex_);
    track_next(prepared(given));
    return slam_->update_map();
  }
  /// Returns the final trajectory; a second call returns it again.
  Trajectory finish(const Progress& progress);

  /// Calls `read(slam)` while no frame is processed.
  template <class Read>
  auto with_slam(const Read& read) {
    const std::lock_guard lock(mutex_);
    return read(std::as_const(*slam_));
  }

  /// Returns where the input contradicts itself, as far as that is known.
  [[nodiscard]] std::vector<InputWarning> warnings();

  [[nodiscard]] ColoredCloud fuse_cloud(const Progress& progress);
  [[nodiscard]] TexturedMesh reconstruct(const MeshOptions& options, const Progress& progress);
  [[nodiscard]] FileFrame file_frame();
  [[nodiscard]] UpEstimate up();
  void save_map(const std::filesystem::path& path);

  [[nodiscard]] const RgbdCamera& camera() const { return camera_; }
  [[nodiscard]] const RunOptions& options() const { return options_; }

 private:
  void require_unfinished() const;
  Frame prepared(const PyFrame& frame);
  Frame prepared(const ArrayFrame& given);
  TrackedFrame track_next(Frame frame);

  std::mutex mutex_;
  RgbdCamera camera_;
  RunOptions options_;
  int threads_ = 1;
  uint64_t id_;
  std::string input_;  // for the map file
  std::optional<Slam> slam_;
  std::optional<DenseRecorder> recorder_;
  std::optional<InputMonitor> input_monitor_;
  DepthPreparation prepare_depth_;
  std::optional<Trajectory> trajectory_;  // set by finish
  uint32_t next_id_ = 0;                  // of a frame in arrays, without those of loaded maps
  int64_t last_stamp_ns_ = std::numeric_limits<int64_t>::min();
};

}  // namespace kinloop::python
