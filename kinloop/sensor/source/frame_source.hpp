#pragma once
// Frame sources: recorded sequences, the simulator, cameras.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// A frame that was skipped, and why.
struct SkippedFrame {
  std::string name;
  std::string reason;
};

/// The frames that a source skipped: of a bad file or a long live run there may be millions. Keeps the first
/// ones and counts them all. Iterates over those kept.
class SkippedFrames {
 public:
  static constexpr size_t kKept = 100;

  /// Adds a frame `count` times.
  void add(const SkippedFrame& frame, size_t count = 1) {
    total_ += count;
    for (size_t i = 0; i < count && first_.size() < kKept; ++i) first_.push_back(frame);
  }

  void add(const SkippedFrames& others) {
    for (const SkippedFrame& frame : others.first_) add(frame);
    total_ += others.size() - others.first_.size();
  }

  void clear() { *this = {}; }

  /// Number of all, not only of those kept.
  [[nodiscard]] size_t size() const { return total_; }
  [[nodiscard]] bool empty() const { return total_ == 0; }
  [[nodiscard]] const SkippedFrame& front() const { return first_.front(); }
  [[nodiscard]] auto begin() const { return first_.begin(); }
  [[nodiscard]] auto end() const { return first_.end(); }

 private:
  std::vector<SkippedFrame> first_;
  size_t total_ = 0;
};

/// Properties of a source. `frames` is 0 for a live camera.
struct SourceInfo {
  std::string name;             ///< as given by the user
  size_t frames = 0;            ///< number of frames that `next` will return or skip
  std::string description;      ///< what a recording was recognised as; may be empty
  std::string serial = {};      ///< number of a live camera; empty if unknown
  bool live = false;            ///< frames arrive in real time and are lost if not taken
  Trajectory ground_truth;      ///< empty if there is none
  bool truth_in_metres = true;  ///< false: in an arbitrary unit, as COLMAP has
};

/// Returns whether a source should end, as after Ctrl-C. A source that waits for its sender or device asks
/// several times a second, on any of its threads; once true, it must stay so. Empty: never.
using StopRequest = std::function<bool()>;

/// Delivers the frames of a recording, a camera or the simulator.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Returns the next frame in order of time; nullopt at the end. Damaged frames are skipped and counted.
  virtual std::optional<Frame> next() = 0;

  [[nodiscard]] virtual const RgbdCamera& camera() const = 0;
  [[nodiscard]] virtual const SourceInfo& info() const = 0;

  /// Returns the frames skipped so far.
  [[nodiscard]] virtual SkippedFrames skipped() const = 0;
};

}  // namespace kinloop
