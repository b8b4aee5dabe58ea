#pragma once
// Tells of input that contradicts itself while a run goes on.

#include <vector>

#include "kinloop/core/timings.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/input/checks/input_checker.hpp"

namespace kinloop {

/// Checks the frames of a run, logs each warning once and keeps it.
class InputMonitor {
 public:
  explicit InputMonitor(const RgbdCamera& camera) : camera_(camera), checker_(camera) {}

  /// Adds a frame, as measured. Throws InputError if nothing useful can come of such frames.
  void observe(const Frame& frame);

  /// Ends the frames, after the run has ended; a second call does nothing. `truth` are the poses in metres
  /// that came with the recording, if any did.
  void finish(const Slam& slam, const Trajectory& truth);

  [[nodiscard]] const std::vector<InputWarning>& warnings() const { return warnings_; }
  [[nodiscard]] const Timings& timings() const { return timings_; }

 private:
  void keep(std::vector<InputWarning> found);

  RgbdCamera camera_;
  InputChecker checker_;
  Timings timings_;
  std::vector<InputWarning> warnings_;
  bool finished_ = false;
};

}  // namespace kinloop
