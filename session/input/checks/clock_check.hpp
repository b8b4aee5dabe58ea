#pragma once
// Whether stamps are in the unit and at the rate that the camera states, and whether depth was taken at the
// time of colour.

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/frame.hpp"
#include "session/input/checks/input_warning.hpp"

namespace kinloop {

/// How much two streams move from frame to frame, and how well that agrees if one is moved in time.
struct MotionLag {
  int frames = 0;          ///< depth is late by so many frames
  double correlation = 0;  ///< there
  double without_lag = 0;  ///< correlation as it is, at most two frames off
  double score = 0;        ///< how sure the correlation is, in standard deviations of noise
  double elsewhere = 0;    ///< the highest score at other lags
};

/// Returns the lag up to `max_lag` frames at which the motion of depth most surely follows that of colour.
/// Both signals must overlap by at least 60 frames; nullopt for too few frames. Throws std::logic_error if
/// they differ in length.
std::optional<MotionLag> motion_lag(std::vector<float> color, std::vector<float> depth, int max_lag);

/// Collects the stamps and the motion of both images.
class ClockCheck {
 public:
  /// `fps` is the rate that the camera states; 0 if it is not known.
  explicit ClockCheck(double fps) : fps_(fps) {}

  /// Frames must be in order of time.
  void observe(const Frame& frame);

  /// Returns whether stamps are in another unit, or far from the stated rate.
  [[nodiscard]] std::optional<InputWarning> stamps() const;

  /// Returns whether depth is late or early by 0.2 s or more.
  [[nodiscard]] std::optional<InputWarning> depth_clock() const;

 private:
  void add_motion(const Frame& frame);
  [[nodiscard]] double median_interval_s() const;

  double fps_;
  std::optional<int64_t> last_ns_;
  std::vector<double> intervals_s_;  // of the first frames
  cv::Mat gray_, inverse_depth_;     // of the previous frame, small
  std::vector<float> color_motion_, depth_motion_;
};

}  // namespace kinloop
