#pragma once
// In: a mesh and posed images. Out: for each triangle the views that could texture it, and how well.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dense/image_store.hpp"
#include "dense/mesh/colored_mesh.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Returns the depth z of the nearest surface at each undistorted pixel, 32FC1, metres; infinity where there
/// is none.
cv::Mat render_depth(const ColoredMesh& mesh, const SE3& T_camera_world, const PinholeCamera& camera);

/// A view that sees a triangle as a whole.
struct ViewCandidate {
  uint32_t view = 0;  ///< index into the views
  float quality = 0;  ///< pixels per square metre of surface, times factors of at most 1 for what spoils them
  Eigen::Vector3f color_bgr = Eigen::Vector3f::Zero();  ///< mean over the triangle, times the view's gain
};

/// The candidates of each triangle, in order of their views.
using ViewCandidates = std::vector<std::vector<ViewCandidate>>;

/// Returns at most 16 candidates for each triangle: the best by resolution, angle, sharpness of the image,
/// exposure, and distance from its border. What the mesh or the measured depth hides is no candidate; a view
/// in which the triangle has another colour than in most others, as where someone walked by, is a bad one.
/// The result does not depend on `threads`.
ViewCandidates find_view_candidates(const ColoredMesh& mesh, const StoredViews& stored, int threads,
                                    const Progress& progress = {});

}  // namespace kinloop
