#pragma once
// The checks of the input, one a source: what each of them keeps of the frames, and what it finds.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/time.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "session/input/checks/input_warning.hpp"
#include "session/input/measures/depth_steps.hpp"
#include "session/input/measures/edge_alignment.hpp"

namespace kinloop {

// Whether the intrinsics of a camera can be those of its images.

/// Returns what is wrong: the intrinsics fit images of another size, the principal point is far from the
/// middle, or the field of view is that of no RGB-D camera.
std::optional<InputWarning> check_intrinsics(const PinholeCamera& camera);

// Whether depth is registered to colour: each depth pixel belongs to the colour pixel at the same place.

/// What edges say about the registration.
enum class Registration {
  kUnknown,  ///< too few edges, or they agree nowhere
  kRegistered,
  kShifted,
  kScaled,
  kMirrored,
};

/// Returns the verdict on an alignment.
Registration judge_registration(const EdgeAlignment& alignment);

/// Compares the edges of frames that are spread over all that was seen so far, at most 20.
class RegistrationCheck {
 public:
  /// `camera` is that of colour.
  explicit RegistrationCheck(const PinholeCamera& camera) : camera_(camera) {}

  /// Adds a frame. Returns a warning as soon as depth is certainly mirrored.
  std::optional<InputWarning> observe(const Frame& frame);

  /// Returns how depth lies to colour; nullopt if there are too few borders.
  [[nodiscard]] std::optional<EdgeAlignment> alignment() const;

  /// Returns what is wrong.
  [[nodiscard]] std::optional<InputWarning> verdict() const;

 private:
  [[nodiscard]] std::optional<InputWarning> warning_of(const EdgeAlignment& alignment) const;
  [[nodiscard]] const std::vector<EdgeSample>& samples() const;

  PinholeCamera camera_;
  std::vector<EdgeImages> images_;
  // Of the first images_: made when they are needed, since most images are dropped before.
  mutable std::vector<EdgeSample> samples_;
  size_t frames_ = 0, interval_ = 1;  // every interval-th frame is taken
};

// Whether the values of depth are those of a sensor, and in the unit that the camera states.

/// Counts the values of depth images: of the first all, of later ones some, which repeat what those show.
class DepthValuesCheck {
 public:
  explicit DepthValuesCheck(const RgbdCamera& camera)
      : camera_(camera), levels_(camera.depth_scale), steps_(levels_.unit_m()) {}

  void observe(const Frame& frame) {
    constexpr size_t kFirst = 90, kInterval = 16;  // frames; the first ones may all have one distance
    if (frames_++ >= kFirst && frames_ % kInterval != 0) return;
    levels_.add(frame.depth_m);
    steps_.add(frame.depth_m);
  }

  /// Returns whether depth is constant, clipped or in coarse steps.
  [[nodiscard]] std::optional<InputWarning> values() const;

  /// Returns whether the steps of depth are those of a structured-light sensor in another unit. The map
  /// cannot tell: with all depths twice as large, so are all distances.
  [[nodiscard]] std::optional<InputWarning> unit() const;

 private:
  RgbdCamera camera_;
  size_t frames_ = 0;
  DepthLevels levels_;
  DisparitySteps steps_;
};

// Whether one of the two streams hangs: its image repeats, to the last bit, while the other one goes on.

/// The times at which one stream hung for half a second or longer, and at least three frames.
class FrozenTimes {
 public:
  /// Adds the interval up to a frame; `frozen` is whether its image repeats that of the frame before.
  void add(int64_t from_ns, int64_t to_ns, bool frozen);

  struct Interval {
    int64_t from_ns = 0, to_ns = 0;
    int frames = 0;

    [[nodiscard]] double duration_s() const { return to_seconds(to_ns - from_ns); }
    [[nodiscard]] bool is_long() const;
  };

  [[nodiscard]] std::vector<Interval> intervals() const;

 private:
  std::vector<Interval> past_;  // the long ones
  Interval current_;
};

/// Compares a grid of pixels of each frame with those of the previous frame.
class FrozenCheck {
 public:
  /// Frames must be in order of time.
  void observe(const Frame& frame);

  [[nodiscard]] std::optional<InputWarning> depth() const;
  [[nodiscard]] std::optional<InputWarning> color() const;

 private:
  std::vector<uint8_t> gray_;  // of the previous frame
  std::vector<float> depth_m_;
  std::optional<int64_t> first_ns_;
  int64_t stamp_ns_ = 0;
  FrozenTimes frozen_depth_, frozen_color_;
};

// Whether stamps are in the unit and at the rate that the camera states, and whether depth was taken at the
// time of colour.

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

// In: the path of the camera, and poses that came with the recording. Out: whether one is a multiple of the
// other. Without such poses nobody can tell: with all depths twice as large, the path and the landmarks are
// twice as large, and so every parallax is the same.

/// Returns a warning if `estimate` agrees with `truth`, but only at another scale. `depth_scale` is in units
/// per metre, as stated by the camera; nullopt if depth is stored in metres, which no depth_scale changes.
std::optional<InputWarning> check_path_scale(const Trajectory& estimate, const Trajectory& truth,
                                             std::optional<double> depth_scale);

}  // namespace kinloop
