#pragma once
// How far a pose is believed, and why not.

#include <cstdint>
#include <optional>
#include <string_view>

namespace kinloop {

/// Why a pose is in doubt.
enum class DoubtCause : uint8_t {
  kNone,          ///< it is not
  kUnknown,       ///< not recorded, as in older map files
  kSurfaces,      ///< surfaces contradict it
  kMoving,        ///< most of the view has moved
  kFewLandmarks,  ///< hardly any landmark supports it
  kHidden,        ///< hardly any of the landmarks that should be in view are found
  kDrift,         ///< dense odometry has accumulated too much uncertainty
  kScale,         ///< nothing holds the scale
  kPlace,         ///< the place was recognized, and later frames have not confirmed it
  kFrozen,        ///< the image is that of an earlier frame
  kNoDepth,       ///< there has been no depth for long
  kFixedRegion,   ///< it was influenced by something that moves with the camera
  kWithdrawn,     ///< it was relative to a keyframe that has turned out to be wrong
  kUnmeasured,    ///< it follows from the motion before and after, and may be far off
  kJump,          ///< no hand moves a camera like that
  kNeighbours,    ///< the frames around it are in doubt
};

/// Whether there is only too little evidence for the pose, and none against it.
constexpr bool is_weak_evidence(DoubtCause cause) {
  return cause == DoubtCause::kFewLandmarks || cause == DoubtCause::kDrift;
}

/// Returns the cause as frames.txt has it, such as "few_landmarks"; "-" for none.
std::string_view name_of(DoubtCause cause);

/// Returns the cause of that number, as map files have it; nullopt if there is none.
std::optional<DoubtCause> doubt_cause(int64_t number);

/// Whether a pose is believed. `doubt` sets the cause; a new estimate begins without one.
struct Trust {
  /// The first that was found; evidence against the pose counts before too little of it.
  DoubtCause cause = DoubtCause::kNone;
};

}  // namespace kinloop
