#pragma once
// Where frames come from: a recorded sequence, the simulator, a camera.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"

namespace kinloop {

/// A frame that could not be used: which, and why.
struct SkippedFrame {
  std::string name;
  std::string reason;
};

/// What a source knows about itself. `frames` is 0 for a live camera.
struct SourceInfo {
  std::string name;         ///< as the user wrote it
  size_t frames = 0;        ///< number of frames that `next` will give or skip
  bool live = false;        ///< frames come at their own pace and are lost if not taken
  Trajectory ground_truth;  ///< empty where there is none
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// The next frame in order of time; nothing at the end. Damaged frames are skipped and counted.
  virtual std::optional<RgbdFrame> next() = 0;

  [[nodiscard]] virtual const RgbdCamera& camera() const = 0;
  [[nodiscard]] virtual const SourceInfo& info() const = 0;

  /// The frames skipped so far.
  [[nodiscard]] virtual std::vector<SkippedFrame> skipped() const = 0;
};

}  // namespace kinloop
