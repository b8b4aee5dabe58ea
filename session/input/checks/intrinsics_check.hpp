#pragma once
// Whether the intrinsics of a camera can be those of its images.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "session/input/checks/input_warning.hpp"

namespace kinloop {

/// Returns what is wrong: the intrinsics fit images of another size, the principal point is far from the
/// middle, or the field of view is that of no RGB-D camera.
std::optional<InputWarning> check_intrinsics(const PinholeCamera& camera);

}  // namespace kinloop
