#pragma once
// Whether the numbers of a camera, from a file that may be damaged or hostile, can be those of a camera.

#include <string>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns whether every number is finite and in a range that admits any camera, from fish-eye to telephoto,
/// and crops of larger images.
bool is_possible(const PinholeCamera& camera);
bool is_possible(const RgbdCamera& camera);

/// Throws InputError naming `source` and the remedy for an impossible camera.
void require_possible(const RgbdCamera& camera, const std::string& source);

}  // namespace kinloop
