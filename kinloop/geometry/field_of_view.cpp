#include "kinloop/geometry/field_of_view.hpp"

namespace kinloop {

std::optional<Eigen::Vector2d> undistort_in_view(const PinholeCamera& camera, const Eigen::Vector2d& raw) {
  constexpr double kSamePixel_px = 0.1;
  const Eigen::Vector2d undistorted = camera.undistort(raw);
  if (!((camera.distort(undistorted) - raw).norm() < kSamePixel_px)) return std::nullopt;
  return undistorted;
}

}  // namespace kinloop
