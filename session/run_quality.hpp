#pragma once
// In: the frames of a run. Out: a verdict on the run as a whole.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// How far the result of a frame can be trusted.
enum class FrameTrust {
  kTrusted,
  kDoubtful,
  kElsewhere,  ///< located in a component of the map other than that of most frames
  kLost,
};

/// A frame to be judged.
struct JudgedFrame {
  int64_t stamp_ns = 0;
  FrameTrust trust = FrameTrust::kLost;
  double fixed_share = 0;   ///< of the image, left out since it moves with the camera
  double moved_share = 0;   ///< of the image, left out since it shows things that have moved
  double depth_factor = 1;  ///< by which depth was multiplied to keep its scale; 0 = frozen or missing
};

enum class Verdict { kGood, kDoubtful, kBad };

/// The verdict on a run. A frame counts for the time until the next one, but for at most 1 s.
struct RunQuality {
  Verdict verdict = Verdict::kBad;
  double seconds = 0;
  double seconds_doubtful = 0;
  double seconds_lost = 0;           ///< lost or located elsewhere
  std::vector<std::string> reasons;  ///< a clause each: "3.2 s of 33.3 s are in doubt (...)"
};

/// Returns the frames of a log in the form to be judged.
std::vector<JudgedFrame> judged_frames(std::span<const LoggedFrame> log, const Map& map);

/// Returns the verdict: good if less than 0.5 % of the time is in doubt or lost, bad if over 20 % is, or if
/// there are no frames; else doubtful. The frames must be in order of time.
RunQuality judge(std::span<const JudgedFrame> frames);

/// Returns the verdict if the unit of depth is guessed, as `guess` says: all lengths depend on it, so that it
/// is not good. The same if `guess` is empty.
RunQuality with_guessed_unit(RunQuality quality, const std::string& guess);

/// Returns "good", "doubtful" or "bad".
const char* name_of(Verdict verdict);

}  // namespace kinloop
