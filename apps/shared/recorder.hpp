#pragma once
// In: frames at a camera's rate. Out: a folder in TUM layout; several threads compress and write the images.

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

#include "drivers/datasets/tum_writer.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"

namespace kinloop {

/// Frames are queued in memory while the disk is busy; `add` blocks only if kMaxQueued frames wait.
class Recorder {
 public:
  static constexpr size_t kMaxQueued = 120;  ///< four seconds; about 260 MB at 640 x 480

  Recorder(const std::filesystem::path& folder, const RgbdCamera& camera, int threads);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Stamps must increase. Rethrows the error of writing an earlier frame.
  void add(RgbdFrame frame);

  /// Waits until all frames are written, then writes the lists.
  void finish(const Trajectory& ground_truth);

  [[nodiscard]] size_t max_queued() const { return max_queued_; }

 private:
  void work(const std::stop_token& stop);
  void rethrow();

  TumWriter writer_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<RgbdFrame> queue_;
  size_t in_progress_ = 0, max_queued_ = 0;
  std::exception_ptr error_;
  std::vector<std::jthread> threads_;  // declared last: they use all of the above
};

}  // namespace kinloop
