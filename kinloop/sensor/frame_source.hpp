#pragma once
// Frame sources: recorded sequences, the simulator, cameras.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/rgbd_camera.hpp"
#include "kinloop/sensor/skipped_frames.hpp"

namespace kinloop {

/// Properties of a source. `frames` is 0 for a live camera.
struct SourceInfo {
  std::string name;         ///< as given by the user
  size_t frames = 0;        ///< number of frames that `next` will return or skip
  std::string description;  ///< what a recording was taken for; empty if there is nothing to say
  bool live = false;        ///< frames arrive in real time and are lost if not taken
  Trajectory ground_truth;  ///< empty if there is none
};

/// Returns whether a source should end, as after Ctrl-C. A source that waits for its sender or device asks
/// several times a second, on any of its threads; once true, it must stay so. Empty: never.
using StopRequest = std::function<bool()>;

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
