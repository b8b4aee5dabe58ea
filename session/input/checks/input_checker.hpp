#pragma once
// In: the frames of a recording or camera. Out: where they contradict themselves or their camera, from the
// images and stamps alone. It costs well under a millisecond per frame.

#include <vector>

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "session/input/checks/checks.hpp"
#include "session/input/checks/input_warning.hpp"

namespace kinloop {

/// Whether successive frames follow each other in time, or are single frames of a sequence.
enum class FrameOrder { kSuccessive, kSpread };

/// Runs all checks on frames. Each kind of fault is told once.
class InputChecker {
 public:
  explicit InputChecker(const RgbdCamera& camera, FrameOrder order = FrameOrder::kSuccessive);

  /// Adds a frame, as measured, in order of time. Returns what is certain by now and was not told before.
  std::vector<InputWarning> observe(const Frame& frame);

  /// Ends the frames. Returns what was not told before.
  std::vector<InputWarning> finish();

  /// Returns how depth lies to colour; nullopt if that is not known.
  [[nodiscard]] std::optional<EdgeAlignment> alignment() const { return registration_.alignment(); }

 private:
  /// Keeps what was told, and returns what is new.
  std::vector<InputWarning> tell(std::vector<InputWarning> found);

  RgbdCamera camera_;
  FrameOrder order_;
  std::vector<InputFault> told_;
  bool started_ = false;
  RegistrationCheck registration_;
  DepthValuesCheck depth_;
  FrozenCheck frozen_;
  ClockCheck clock_;
};

}  // namespace kinloop
