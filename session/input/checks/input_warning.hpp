#pragma once
// What a checker of the input says: a contradiction, the evidence for it, and what to do.

#include <string>

namespace kinloop {

/// Kinds of input that contradicts itself.
enum class InputFault {
  kDepthNotRegistered,  ///< depth and colour do not show the same view
  kIntrinsics,          ///< of an image of another size
  kDepthUnit,           ///< depth has another unit than stated
  kFocalLength,
  kDepthValues,  ///< few distinct values, or many pixels at one of them
  kFrozenDepth,
  kFrozenColor,
  kStamps,      ///< in another unit, or at another rate than stated
  kDepthClock,  ///< depth was taken at another time than colour
};

/// Returns a name for files: "depth_not_registered".
const char* name_of(InputFault fault);

/// A contradiction in the input.
struct InputWarning {
  InputFault fault = InputFault::kDepthNotRegistered;
  std::string evidence;   ///< a clause: "depth is mirrored left to right (...)"
  std::string remedy;     ///< a clause: "flip the depth images"
  bool hopeless = false;  ///< nothing useful comes of such input
};

/// Returns evidence and remedy as one sentence.
std::string text_of(const InputWarning& warning);

}  // namespace kinloop
