#pragma once
// In: a map. Out: the focal lengths that its images fit, whatever the camera states. Depth gives the size of
// each view and parallax gives it again through the focal length; self-calibration, whose prior trusts the
// camera to a few per mille, cannot follow an error of several per cent.

#include <optional>
#include <vector>

#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

/// Focal lengths relative to those of the camera, with their standard deviations.
struct FocalLengthEstimate {
  double factor_x = 1, factor_y = 1;
  double sigma_x = 0, sigma_y = 0;

  /// Whether both are off by the same few per cent or more, beyond their uncertainty.
  [[nodiscard]] bool contradicts_camera() const;
};

/// Estimates them from the keyframes that see the most points together, a dozen, with the lens of camera.yaml
/// and the times of `sensor`. `velocities` are those of all keyframes. nullopt for too few points.
std::optional<FocalLengthEstimate> estimate_focal_length(const Map& map, const SensorEstimate& sensor,
                                                         std::vector<Velocity> velocities);

}  // namespace kinloop
