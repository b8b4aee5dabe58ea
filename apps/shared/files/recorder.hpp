#pragma once
// In: frames at a camera's rate. Out: a folder in TUM layout or an MCAP file; several threads compress the
// images.

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Where a recording goes.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;

  /// Compresses a frame, and returns what is left to be done in order of the frames. Several threads call it.
  virtual std::function<void()> prepare(const Frame& frame) = 0;

  /// Completes the recording.
  virtual void finish(const Trajectory& ground_truth) = 0;
};

/// Returns the writer of an MCAP file if `path` ends in .mcap, else of a folder in TUM layout. Throws
/// InputError if there is a recording already, or it cannot be created.
std::unique_ptr<FrameWriter> make_frame_writer(const std::filesystem::path& path, const RgbdCamera& camera);

/// Frames are queued in memory while the disk is busy; `add` blocks only if kMaxQueued frames wait.
class Recorder {
 public:
  static constexpr size_t kMaxQueued = 120;  ///< four seconds; about 260 MB at 640 x 480

  /// Depth of the frames is registered to colour.
  Recorder(const std::filesystem::path& path, const RgbdCamera& camera, int threads);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Stamps must increase. Rethrows the error of writing an earlier frame.
  void add(Frame frame);

  /// Waits until all frames are written, then completes the recording.
  void finish(const Trajectory& ground_truth);

  [[nodiscard]] size_t max_queued() const { return max_queued_; }

 private:
  using Lock = std::unique_lock<std::mutex>;

  void work(const std::stop_token& stop);
  void write_in_order(Lock& lock);
  void rethrow();
  [[nodiscard]] size_t unwritten() const { return added_ - written_; }

  std::unique_ptr<FrameWriter> writer_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Frame> queue_;
  std::map<size_t, std::function<void()>> prepared_;  ///< by the number of the frame
  size_t added_ = 0, taken_ = 0, written_ = 0;        ///< frames
  bool writing_ = false;                              ///< by one of the threads
  size_t max_queued_ = 0;
  std::exception_ptr error_;
  std::vector<std::jthread> threads_;  // declared last: they use all of the above
};

}  // namespace kinloop
