#pragma once
// Finds landmarks of the local map in an image by the patches of the keyframes that observe them.

#include <optional>
#include <span>
#include <vector>

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// What a search for landmarks needs besides the image.
struct PatchSearch {
  const LocalMap& local_map;
  const Sensor& sensor;
  Velocity velocity;  ///< of the camera
};

/// A landmark expected in view.
struct ExpectedPatch {
  uint32_t index;        ///< in the local map
  Eigen::Vector2d raw;   ///< predicted raw pixel
  int octave;            ///< on which it has the size of the patch
  Eigen::Matrix2d warp;  ///< raw pixels of the keyframe per raw pixel of the frame
};

/// A landmark found.
struct FoundPatch {
  uint32_t index;
  Eigen::Vector2d raw;
  int octave;
};

/// Expects landmarks in a camera at `T_reference_camera`.
class PatchPredictor {
 public:
  PatchPredictor(const PatchSearch& search, const SE3& T_reference_camera);

  /// Where an ideal global-shutter sensor would see the landmark; nullopt if it is behind the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> nominal_pixel(uint32_t index) const;

  /// Where the sensor sees it; takes several times as long.
  [[nodiscard]] std::optional<Eigen::Vector2d> raw_pixel(uint32_t index) const;

  /// nullopt if the landmark has no patch or is seen at too different a size.
  [[nodiscard]] std::optional<ExpectedPatch> expect(uint32_t index, const Eigen::Vector2d& raw) const;

 private:
  const PatchSearch& search_;
  SE3 T_camera_reference_;
  std::vector<SE3> T_camera_view_;
};

/// Finds the landmark to a fraction of a pixel, within `max_shift_px` on its octave; nullopt if nothing there
/// looks like it.
std::optional<FoundPatch> find_patch(const ImageOctaves& octaves, const ExpectedPatch& expected,
                                     const LocalMap& map, float max_shift_px);

// In: the keypoints of a frame that match landmarks. Out: their positions to a fraction of a pixel.

/// Moves the keypoints of `frame` to where the patches of their landmarks are found, so that every keyframe
/// observes the same point of a surface: corners are detected with an error of about a pixel of their level.
/// A keypoint whose patch is missing, or not found nearby, stays. Not motion-compensated afterwards.
Features refine_keypoints(const Frame& frame, std::span<const LandmarkMatch> matches,
                          const SE3& T_reference_camera, const PatchSearch& search);

}  // namespace kinloop
