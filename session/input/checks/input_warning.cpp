#include "session/input/checks/input_warning.hpp"

#include <fmt/format.h>

namespace kinloop {

const char* name_of(InputFault fault) {
  switch (fault) {
    case InputFault::kDepthNotRegistered:
      return "depth_not_registered";
    case InputFault::kIntrinsics:
      return "intrinsics";
    case InputFault::kDepthUnit:
      return "depth_unit";
    case InputFault::kFocalLength:
      return "focal_length";
    case InputFault::kDepthValues:
      return "depth_values";
    case InputFault::kFrozenDepth:
      return "frozen_depth";
    case InputFault::kFrozenColor:
      return "frozen_color";
    case InputFault::kStamps:
      return "stamps";
    case InputFault::kDepthClock:
      break;
  }
  return "depth_clock";
}

std::string text_of(const InputWarning& warning) {
  return fmt::format("{}; {}", warning.evidence, warning.remedy);
}

}  // namespace kinloop
