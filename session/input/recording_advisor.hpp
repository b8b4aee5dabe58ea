#pragma once
// In: the frames of a run. Out: what spoils the recording at the moment, and what to do about it.

#include <array>
#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

#include "kinloop/slam/listener.hpp"

namespace kinloop {

/// What may spoil a recording, the most urgent first.
enum class RecordingHint { kInDoubt, kTooFast, kNoDepth, kTooNear, kTooDark, kOverexposed, kFewFeatures };

constexpr size_t kRecordingHints = 7;

/// A set of hints, by their numbers.
using RecordingHints = std::bitset<kRecordingHints>;

/// Returns a name for files: "too_fast".
const char* name_of(RecordingHint hint);

/// Returns what is wrong and what to do, in a few words.
const char* text_of(RecordingHint hint);

/// What a frame tells of how it was recorded. The defaults spoil nothing.
struct RecordingSigns {
  bool in_doubt = false;          ///< the pose is doubtful, or there is none
  double image_motion_rad_s = 0;  ///< of the image centre, at most: turn rate plus speed over depth
  double depth_share = 1;         ///< of the pixels, that have depth
  double depth_m = 2;             ///< median of those
  double bright_level = 200;      ///< grey that 95 % of the pixels do not exceed, 0 to 255
  double saturated_share = 0;     ///< of the pixels, that are white
  int inliers = 200;              ///< landmarks that hold the pose
};

/// Returns the signs of a frame, from a sample of its pixels. The frame must have its images.
RecordingSigns signs_of(const TrackedFrame& tracked);

/// Returns what spoils the recording by the signs of one frame. A hint that is given already (`active`) stays
/// until its sign is clearly better.
RecordingHints advice(const RecordingSigns& signs, const RecordingHints& active);

/// Follows a run. A hint begins when its signs have lasted half a second, a fifth for fast motion, since
/// swings are short, at once if the pose is in doubt; and ends when they have been away for two seconds.
class RecordingAdvisor : public Listener {
 public:
  void on_frame(const TrackedFrame& tracked) override { observe(tracked.stamp_ns, signs_of(tracked)); }
  void on_map(const Map&) override {}

  /// Adds the signs of the next frame.
  void observe(int64_t stamp_ns, const RecordingSigns& signs);

  /// Returns the hints for now, the most urgent first, at most three.
  [[nodiscard]] std::vector<RecordingHint> hints() const;

  /// Returns how long a hint was given, s. A frame counts for the time until the next, but for at most 1 s.
  [[nodiscard]] double seconds(RecordingHint hint) const { return seconds_[static_cast<size_t>(hint)]; }

 private:
  RecordingHints active_;
  int64_t stamp_ns_ = 0;                                ///< of the latest frame
  std::array<int64_t, kRecordingHints> changing_ns_{};  ///< since when a hint should begin or end
  std::bitset<kRecordingHints> changing_;
  std::array<double, kRecordingHints> seconds_{};
  bool begun_ = false;
};

}  // namespace kinloop
