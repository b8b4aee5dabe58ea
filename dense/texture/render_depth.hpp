#pragma once
// In: a mesh and a camera. Out: the depth of what the camera sees of it.

#include <opencv2/core/mat.hpp>

#include "dense/mesh/colored_mesh.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Returns the depth z of the nearest surface at each undistorted pixel, 32FC1, metres; infinity where there
/// is none.
cv::Mat render_depth(const ColoredMesh& mesh, const SE3& T_camera_world, const PinholeCamera& camera);

}  // namespace kinloop
