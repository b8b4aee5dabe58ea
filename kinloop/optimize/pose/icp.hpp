#pragma once
// Dense alignment of two depth images (optionally with grey images) by point-to-plane ICP from an initial
// motion. Small eigenvalues of the information matrix show directions that the surfaces leave unconstrained.

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

struct IcpOptions {
  int finest_width = 160;
  int levels = 3;
  int iterations = 7;
  double photometric_weight = 1;
  double min_overlap = 0.2;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("finest_width", self.finest_width, "width of the finest grid of surface points, px",
          Range{20, 1280});
    visit("levels", self.levels, "pyramid levels", Range{1, 6});
    visit("iterations", self.iterations, "Gauss-Newton iterations per level", Range{1, 100});
    visit("photometric_weight", self.photometric_weight, "weight of the photometric term, 0 = depth only",
          Range{0, 100});
    visit("min_overlap", self.min_overlap, "minimum fraction of points with a correspondence", Range{0, 1});
  }
};

/// Data of a camera shared by all its frames. The grids are those of an ideal pinhole camera. A point of the
/// finest grid covers a block of pixels of the (distorted) depth image; a point of a coarser grid covers four
/// points of the next finer one.
struct IcpCamera {
  struct Level {
    PinholeCamera camera;               ///< ideal, scaled to the grid
    std::vector<Eigen::Vector2f> rays;  ///< (x / z, y / z) of each grid point
    cv::Mat map_x, map_y;               ///< grid point to grey image, for cv::remap; empty if undistorted
  };
  DepthNoise noise = {};              ///< of depth on surfaces
  int width = 0, height = 0;          ///< of the images, px
  int block = 1;                      ///< side of the block of pixels per point of the finest grid, px
  std::vector<int32_t> block_corner;  ///< first pixel of each block, y * width + x; -1 = outside the image
  std::vector<Level> levels;          ///< finest first
};

/// Returns the grids for the camera of `sensor`, whose images have its distortion.
IcpCamera make_icp_camera(const Sensor& sensor, const IcpOptions& options);

/// The surface observed in a frame, on each grid.
struct IcpFrame {
  struct Level {
    int width = 0, height = 0;
    std::vector<Eigen::Vector3f> points;   ///< camera frame, m; z = 0 where unknown
    std::vector<Eigen::Vector3f> normals;  ///< towards the camera; zero where unknown
    cv::Mat gray;                          ///< 32FC1, empty without a grey image
  };
  std::vector<Level> levels;  ///< finest first
};

/// Prepares a frame. `depth_m` is 32FC1 with 0 (or NaN) = unknown; `gray` is 8UC1 of the same size, or empty.
IcpFrame make_icp_frame(const IcpCamera& camera, const cv::Mat& depth_m, const cv::Mat& gray = {});

/// Result of dense alignment.
struct IcpSolution {
  SE3 T_reference_camera;
  Matrix6d information = Matrix6d::Zero();  ///< of T * exp(x), x = (translation; rotation)
  double overlap = 0;                       ///< fraction of the frame's points with a correspondence
  double rmse_m = 0;                        ///< of the point-to-plane distances
};

/// Aligns `frame` to `reference`, starting from the guess. Unconstrained directions (along a wall) stay at
/// the guess and have small eigenvalues in the information, which excludes the guess. nullopt if less than
/// `min_overlap` of the points have a correspondence.
std::optional<IcpSolution> align_icp(const IcpCamera& camera, const IcpFrame& reference,
                                     const IcpFrame& frame, const SE3& T_reference_camera_guess,
                                     const IcpOptions& options);

}  // namespace kinloop
