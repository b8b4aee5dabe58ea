#pragma once
// Whether depth is registered to colour: each depth pixel belongs to the colour pixel at the same place.

#include <cstddef>
#include <optional>
#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "session/input/checks/input_warning.hpp"
#include "session/input/measures/edge_alignment.hpp"

namespace kinloop {

/// What edges say about the registration.
enum class Registration {
  kUnknown,  ///< too few edges, or they agree nowhere
  kRegistered,
  kShifted,
  kScaled,
  kMirrored,
};

/// Returns the verdict on an alignment.
Registration judge_registration(const EdgeAlignment& alignment);

/// Compares the edges of frames that are spread over all that was seen so far, at most 20.
class RegistrationCheck {
 public:
  /// `camera` is that of colour.
  explicit RegistrationCheck(const PinholeCamera& camera) : camera_(camera) {}

  /// Adds a frame. Returns a warning as soon as depth is certainly mirrored.
  std::optional<InputWarning> observe(const Frame& frame);

  /// Returns how depth lies to colour; nullopt if there are too few borders.
  [[nodiscard]] std::optional<EdgeAlignment> alignment() const;

  /// Returns what is wrong.
  [[nodiscard]] std::optional<InputWarning> verdict() const;

 private:
  [[nodiscard]] std::optional<InputWarning> warning_of(const EdgeAlignment& alignment) const;
  [[nodiscard]] const std::vector<EdgeSample>& samples() const;

  PinholeCamera camera_;
  std::vector<EdgeImages> images_;
  // Of the first images_: made when they are needed, since most images are dropped before.
  mutable std::vector<EdgeSample> samples_;
  size_t frames_ = 0, interval_ = 1;  // every interval-th frame is taken
};

}  // namespace kinloop
