#pragma once
// What is known of a frame wherever it is kept, also in map files: when it was, how it was tracked, and
// where.

#include <cstdint>

#include "kinloop/core/ids.hpp"
#include "kinloop/map/frames/trust.hpp"
#include "kinloop/map/keyframe_pose.hpp"

namespace kinloop {

/// How the tracking of a frame ended.
enum class TrackingOutcome {
  kLost,         ///< no pose
  kTracked,      ///< located relative to the previous frame and the local map
  kRelocalized,  ///< located by place recognition, or where the motion before did not lead
  kNewMap,       ///< starts a map, or a new component of it
};

/// What a pose was estimated from.
enum class TrackingMethod {
  kKeypoints,  ///< matched descriptors of landmarks, or of points of the previous frame
  kPatches,    ///< patches of landmarks (direct tracking)
  kDense,      ///< dense alignment with the previous frame, since there were too few features
  kRepeat,     ///< none: the image repeats the previous one, whose pose the frame takes
  kPredicted,  ///< none: the motion between the frames before and after, see predict_unmeasured_frames
};

/// A frame and its pose, which is undefined if the frame is lost.
struct FrameRecord : KeyframePose {
  FrameId id;
  int64_t stamp_ns = 0;                ///< of the colour image
  float depth_stamp_difference_s = 0;  ///< stamp of the depth image minus `stamp_ns`
  TrackingOutcome outcome = TrackingOutcome::kLost;
  TrackingMethod method = TrackingMethod::kKeypoints;
  Trust trust;
  KeyframeId keyframe;  ///< valid if the frame became a keyframe

  /// Whether the frame has no pose.
  [[nodiscard]] bool is_lost() const { return outcome == TrackingOutcome::kLost; }

  /// Whether the evidence is too weak to trust the pose: it may be wrong by more than its covariance says.
  [[nodiscard]] bool is_doubtful() const { return trust.cause != DoubtCause::kNone; }

  /// Whether the frame was located in the existing map.
  [[nodiscard]] bool is_located() const {
    return outcome == TrackingOutcome::kTracked || outcome == TrackingOutcome::kRelocalized;
  }

  /// Whether landmarks support the pose.
  [[nodiscard]] bool is_tracked_by_landmarks() const {
    return !is_lost() && method != TrackingMethod::kDense && method != TrackingMethod::kPredicted;
  }

  /// Whether the image repeats the previous one.
  [[nodiscard]] bool is_repeat() const { return method == TrackingMethod::kRepeat; }
};

/// Marks the pose as doubtful, see Trust; no change for none.
void doubt(FrameRecord& frame, DoubtCause cause);

/// Returns whether the frame has a pose in that component of the map.
bool is_tracked_in(uint32_t component, const FrameRecord& frame, const Map& map);

}  // namespace kinloop
