#pragma once

#include <string>
#include <vector>

#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Returns the reason why the first frame was skipped, to be appended to a message; empty if none was.
inline std::string first_reason(const SkippedFrames& skipped) {
  return skipped.empty() ? "" : "; the first: " + skipped.front().reason;
}

}  // namespace kinloop
