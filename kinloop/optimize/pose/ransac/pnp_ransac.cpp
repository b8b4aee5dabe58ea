#include "kinloop/optimize/pose/ransac/pnp_ransac.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <opencv2/calib3d.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/optimize/pose/ransac/ransac.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kSampleSize = 3;

/// Returns the measured points in camera axes; not finite where depth was not measured.
std::vector<Eigen::Vector3d> measured_points(const PinholeCamera& camera,
                                             std::span<const PoseObservation> observations) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(observations.size());
  for (const PoseObservation& o : observations) {
    const double depth_m = o.depth_m > 0 ? o.depth_m : std::numeric_limits<double>::quiet_NaN();
    points.emplace_back((o.pixel.x() - camera.cx) / camera.fx * depth_m,
                        (o.pixel.y() - camera.cy) / camera.fy * depth_m, depth_m);
  }
  return points;
}

/// Whether the side lengths of a sample agree with its measured depths, if any. This cheaply rejects most
/// samples with an outlier before their pose is computed.
bool side_lengths_consistent(std::span<const PoseObservation> observations,
                             const std::vector<Eigen::Vector3d>& measured,
                             const std::vector<uint32_t>& sample, const DepthNoise& noise) {
  constexpr double kMaxSigmas = 4;
  for (size_t i = 0; i < sample.size(); ++i) {
    const uint32_t a = sample[i], b = sample[(i + 1) % sample.size()];
    const double side_m = (observations[a].p_reference - observations[b].p_reference).norm();
    const double measured_m = (measured[a] - measured[b]).norm();
    const double sigma_m = noise.difference_sigma_m(measured[a].z(), measured[b].z());
    if (std::abs(side_m - measured_m) > kMaxSigmas * sigma_m) return false;  // false for NaN
  }
  return true;
}

/// Returns the up to four camera poses that map three points to three rays.
std::vector<SE3> solve_p3p(const PinholeCamera& camera, std::span<const PoseObservation> observations,
                           const std::vector<uint32_t>& sample) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const uint32_t i : sample) {
    const PoseObservation& o = observations[i];
    points.emplace_back(o.p_reference.x(), o.p_reference.y(), o.p_reference.z());
    pixels.emplace_back((o.pixel.x() - camera.cx) / camera.fx, (o.pixel.y() - camera.cy) / camera.fy);
  }
  std::vector<cv::Vec3d> rotations, translations;
  cv::solveP3P(points, pixels, cv::Matx33d::eye(), cv::noArray(), rotations, translations, cv::SOLVEPNP_AP3P);
  std::vector<SE3> poses;
  for (size_t i = 0; i < rotations.size(); ++i) {
    const cv::Vec3d& r = rotations[i];
    const cv::Vec3d& t = translations[i];
    const SE3 T_camera_reference{exp_so3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}};
    if (T_camera_reference.is_finite()) poses.push_back(T_camera_reference.inverse());
  }
  return poses;
}

/// Refines a pose on its inliers, then reclassifies all observations.
std::optional<AbsolutePoseSolution> refine_on_inliers(const Sensor& sensor,
                                                      std::span<const PoseObservation> observations,
                                                      const SE3& T, const AbsolutePoseOptions& options) {
  const std::vector<uint8_t> agree = pixel_inliers(sensor, observations, T);
  std::vector<PoseObservation> chosen;
  std::vector<size_t> index;
  for (size_t i = 0; i < agree.size(); ++i) {
    if (!agree[i]) continue;
    chosen.push_back(observations[i]);
    index.push_back(i);
  }
  auto solution = solve_absolute_pose(sensor, chosen, T, options);
  if (!solution) return std::nullopt;
  std::vector<uint8_t> inliers(observations.size(), 0);
  for (size_t k = 0; k < index.size(); ++k) inliers[index[k]] = solution->inliers[k];
  solution->inliers = std::move(inliers);
  return solution;
}

/// Refines until the number of inliers stops growing (Chum 2003).
std::optional<AbsolutePoseSolution> local_optimization(const Sensor& sensor,
                                                       std::span<const PoseObservation> observations,
                                                       const SE3& T, const AbsolutePoseOptions& options) {
  constexpr int kMaxRounds = 5;
  auto best = refine_on_inliers(sensor, observations, T, options);
  for (int i = 1; best && i < kMaxRounds; ++i) {
    const auto next = refine_on_inliers(sensor, observations, best->T_reference_camera, options);
    if (!next || next->inlier_count <= best->inlier_count) break;
    best = next;
  }
  return best;
}

std::vector<uint32_t> usable_indices(std::span<const PoseObservation> observations) {
  std::vector<uint32_t> usable;
  for (uint32_t i = 0; i < observations.size(); ++i) {
    const PoseObservation& o = observations[i];
    if (o.p_reference.allFinite() && o.pixel.allFinite() && o.sigma_px > 0) usable.push_back(i);
  }
  return usable;
}

}  // namespace

std::optional<AbsolutePoseSolution> solve_pnp_ransac(const Sensor& sensor,
                                                     std::span<const PoseObservation> observations,
                                                     const PnpRansacOptions& options,
                                                     const AbsolutePoseOptions& pose_options, uint64_t seed) {
  const std::vector<uint32_t> usable = usable_indices(observations);
  const int needed = std::max<int>(options.min_inliers, kSampleSize + 1);
  if (usable.size() < static_cast<size_t>(needed)) return std::nullopt;

  const auto measured = measured_points(sensor.camera, observations);
  Random random(seed);
  std::optional<AbsolutePoseSolution> best;
  int best_count = 0;  // inlier count of the best sample before refinement
  double samples = options.max_iterations;
  for (int i = 0; i < samples; ++i) {
    const std::vector<uint32_t> sample = draw_sample(random, usable, kSampleSize);
    if (!side_lengths_consistent(observations, measured, sample, sensor.noise.keypoint)) continue;
    for (const SE3& T : solve_p3p(sensor.camera, observations, sample)) {
      const auto agree = pixel_inliers(sensor, observations, T);
      const int count = std::accumulate(agree.begin(), agree.end(), 0);
      if (count <= best_count) continue;
      best_count = count;
      const auto refined = local_optimization(sensor, observations, T, pose_options);
      if (refined && (!best || refined->inlier_count > best->inlier_count)) best = refined;
    }
    if (best)
      samples = std::min(
          samples, required_samples(best->inlier_count, usable.size(), kSampleSize, options.confidence));
  }
  if (!best || best->inlier_count < needed) return std::nullopt;
  return best;
}

}  // namespace kinloop
