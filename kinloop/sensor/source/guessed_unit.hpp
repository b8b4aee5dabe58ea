#pragma once
// Sources whose unit of depth nobody states.

#include <string>

namespace kinloop {

/// Implemented by a FrameSource that may have to guess the unit of its depth, which changes all lengths.
class GuessedUnit {
 public:
  virtual ~GuessedUnit() = default;

  /// Returns a clause for users that says so; empty if the unit is stated.
  [[nodiscard]] virtual const std::string& depth_unit_guess() const = 0;
};

}  // namespace kinloop
