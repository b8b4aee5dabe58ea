#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kinloop/core/association.hpp"
#include "kinloop/geometry/rigid_alignment.hpp"
#include "session/input/checks/checks.hpp"
#include "session/input/measures/usual_depth_scale.hpp"

namespace kinloop {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// The standard deviation about the mean.
double spread_of_points(const Points& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& point : points) mean += point / static_cast<double>(points.size());
  double sum = 0;
  for (const auto& point : points) sum += (point - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(points.size()));
}

/// The remaining distance, RMS, after the best rigid motion.
std::optional<double> distance_m(const Points& a, const Points& b) {
  const auto T_a_b = align_rigid(a, b);
  if (!T_a_b) return std::nullopt;
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - *T_a_b * b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// `scale` is that of the path, over that of the poses.
std::string remedy(double scale, std::optional<double> depth_scale, double tolerance) {
  if (!depth_scale)
    return fmt::format(
        "depth seems to be in another unit: divide it by {:.3g}, unless those poses have another unit",
        scale);
  return fmt::format("use --depth-scale {} instead of {:g}, unless those poses have another unit",
                     depth_scale_text(scale * *depth_scale, *depth_scale, tolerance), *depth_scale);
}

}  // namespace

std::optional<InputWarning> check_path_scale(const Trajectory& estimate, const Trajectory& truth,
                                             std::optional<double> depth_scale) {
  constexpr size_t kFewest = 20;
  constexpr double kMinSpread_m = 0.05, kSame = 1.1, kAgrees = 0.1;
  constexpr double kMaxPoseError_m = 0.05;  // of published poses, which are estimates, too
  Points found, true_points;
  for (const StampPair& pair : associate_stamps(stamps_of(estimate), stamps_of(truth))) {
    found.push_back(estimate[pair.a].T_world_camera.translation);
    true_points.push_back(truth[pair.b].T_world_camera.translation);
  }
  if (found.size() < kFewest) return std::nullopt;
  const double spread_m = spread_of_points(found), true_spread_m = spread_of_points(true_points);
  if (!(spread_m > kMinSpread_m) || !(true_spread_m > 0)) return std::nullopt;
  const double scale = spread_m / true_spread_m;
  if (std::max(scale, 1 / scale) < kSame || std::abs(spread_m - true_spread_m) < kMaxPoseError_m)
    return std::nullopt;
  for (auto& point : true_points) point *= scale;
  const auto distance = distance_m(found, true_points);
  if (!distance || *distance > kAgrees * spread_m) return std::nullopt;
  return InputWarning{
      InputFault::kDepthUnit,
      fmt::format(
          "the path of the camera is {:.3g} times as large as in the poses of the recording, from which "
          "it differs by {:.3f} m otherwise, as if all depths were {:.3g} times too {}",
          scale, *distance, std::max(scale, 1 / scale), scale > 1 ? "large" : "small"),
      remedy(scale, depth_scale, kSame), false};
}

}  // namespace kinloop
