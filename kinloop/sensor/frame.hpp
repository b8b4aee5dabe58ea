#pragma once
// A frame of an RGB-D camera: what was measured, and what is computed from it alone.

#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/ids.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/images/color_image.hpp"

namespace kinloop {

struct Features;
struct SurfaceGrid;

/// Time spent on a frame before tracking, for reports.
struct PreparationTime {
  ElapsedTime decoding;    ///< in the source
  ElapsedTime preparing;   ///< grey image and octaves
  ElapsedTime extracting;  ///< keypoints, if they were extracted ahead
  /// When the images were there: arrived from a camera, or decoded.
  std::optional<std::chrono::steady_clock::time_point> read_at;
};

/// A frame. The source fills in the measured part; the front end adds the rest, possibly ahead of tracking on
/// another thread.
struct Frame {
  FrameId id;                             ///< index of the frame in its source, from 0
  int64_t stamp_ns = 0;                   ///< of the colour image
  ColorImage color;                       ///< decoded to BGR only on request
  cv::Mat depth_m;                        ///< 32FC1, z in metres at each pixel of `color`, 0 = unknown
  cv::Mat infrared = {};                  ///< 16UC1, as seen by the depth camera; empty unless requested
  std::optional<int64_t> depth_stamp_ns;  ///< of the depth image; nullopt: not known
  cv::Mat mask = {};  ///< 8UC1 of the size of `color`, 0 = the user wants it ignored; empty = all is used

  cv::Mat ignored =
      {};  ///< 8UC1 of the size of `color`, bits of IgnoreCause; empty until prepared or if all is used
  cv::Mat gray = {};                                 ///< 8UC1; empty until prepared
  std::vector<cv::Mat> octaves = {};                 ///< image pyramid of `gray`, see make_octaves
  std::shared_ptr<const SurfaceGrid> surfaces = {};  ///< of `depth_m`; null until prepared
  /// All keypoints with descriptors; null until extracted. For a frame tracked by patches, only the landmarks
  /// found, without descriptors.
  std::shared_ptr<const Features> features = {};
  PreparationTime time = {};

  /// Returns the stamp of the depth image, or that of the colour image if it is not known.
  [[nodiscard]] int64_t depth_stamp_or_color_ns() const { return depth_stamp_ns.value_or(stamp_ns); }
};

/// Returns the stamp of the depth image minus that of the colour image, s; 0 if they are too far apart to
/// come from the same clock.
inline float depth_stamp_difference_s(const Frame& frame) {
  constexpr double kMaxDifference_ns = 5e7;
  const int64_t depth_ns = frame.depth_stamp_or_color_ns();
  // Compared in floating point, since the difference of arbitrary stamps overflows.
  const bool near =
      std::abs(static_cast<double>(depth_ns) - static_cast<double>(frame.stamp_ns)) < kMaxDifference_ns;
  return near ? static_cast<float>(to_seconds(depth_ns - frame.stamp_ns)) : 0.0F;
}

}  // namespace kinloop
