#pragma once

namespace kinloop {

/// Returns the nearest integer of a value within the range of int, halves away from zero. Same as
/// std::lround, but inline and without branches.
inline int rounded(float value) {
  const auto whole = static_cast<int>(value);
  const float rest = value - static_cast<float>(whole);
  return whole + static_cast<int>(rest >= 0.5F) - static_cast<int>(rest <= -0.5F);
}

}  // namespace kinloop
