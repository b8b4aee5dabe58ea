#include "dense/up_direction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace kinloop {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// How far a normal may deviate from horizontal or vertical: several times the noise of normals.
constexpr double kBand_rad = 10 * kDegree;

using Normals = std::vector<Eigen::Vector3d>;

/// Fractions of the total surface, given `up`.
struct Shares {
  double above = 0;    ///< horizontal, seen from above
  double below = 0;    ///< horizontal, seen from below
  double upright = 0;  ///< walls

  [[nodiscard]] double explained() const { return above + below + upright; }
};

/// A candidate for the up direction and its log likelihood, up to a constant.
struct Candidate {
  Eigen::Vector3d up;
  double log_likelihood = 0;
  bool determined = false;  ///< the surfaces constrain both degrees of freedom
};

/// An evenly spaced subset of the normals, to bound the work.
Normals chosen(std::span<const Eigen::Vector3f> normals) {
  constexpr size_t kMaxCount = 20'000;
  const size_t step = normals.size() / kMaxCount + 1;
  Normals some;
  for (size_t i = 0; i < normals.size(); i += step) {
    const Eigen::Vector3d normal = normals[i].cast<double>();
    if (std::abs(normal.squaredNorm() - 1) < 0.1) some.push_back(normal.normalized());
  }
  return some;
}

Shares shares_of(const Eigen::Vector3d& up, const Normals& normals) {
  const double level = std::cos(kBand_rad), upright = std::sin(kBand_rad);
  size_t above = 0, below = 0, walls = 0;
  for (const Eigen::Vector3d& normal : normals) {
    const double along = up.dot(normal);
    above += static_cast<size_t>(along > level);
    below += static_cast<size_t>(along < -level);
    walls += static_cast<size_t>(std::abs(along) < upright);
  }
  const double all = static_cast<double>(normals.size());
  return {static_cast<double>(above) / all, static_cast<double>(below) / all,
          static_cast<double>(walls) / all};
}

/// Directions spread evenly over a half sphere (Fibonacci lattice), 4 degrees apart.
std::vector<Eigen::Vector3d> hemisphere_directions() {
  constexpr int kCount = 1500;
  const double golden_rad = std::numbers::pi * (3 - std::sqrt(5));
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kCount; ++i) {
    const double z = (i + 0.5) / kCount, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(golden_rad * i), r * std::sin(golden_rad * i), z);
  }
  return directions;
}

/// Refines `up` by least squares so that horizontal surfaces are perpendicular to it and walls parallel,
/// using the surfaces within the band (which is tightened as the estimate improves).
Candidate refined(Eigen::Vector3d up, const Normals& normals) {
  Candidate candidate;
  for (const double band_rad : {1.5 * kBand_rad, kBand_rad, kBand_rad, kBand_rad / 2, kBand_rad / 2}) {
    Eigen::Matrix3d cost = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& normal : normals) {
      const double along = up.dot(normal);
      if (std::abs(along) < std::sin(band_rad)) {
        cost += normal * normal.transpose();
      } else if (std::abs(along) > std::cos(band_rad)) {
        cost += Eigen::Matrix3d::Identity() - normal * normal.transpose();
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(cost / static_cast<double>(normals.size()));
    constexpr double kMinCurvature =
        0.05;  // share of the surface that must constrain the weaker degree of freedom
    candidate.determined = solver.eigenvalues()(1) - solver.eigenvalues()(0) > kMinCurvature;
    if (!candidate.determined) break;
    const Eigen::Vector3d axis = solver.eigenvectors().col(0);
    up = axis.dot(up) < 0 ? Eigen::Vector3d(-axis) : axis;
  }
  candidate.up = up;
  return candidate;
}

/// The axes that explain most of the surface, well separated from each other.
std::vector<Candidate> best_axes(const Normals& normals) {
  constexpr size_t kMaxCount = 12;
  constexpr double kApart_rad = 20 * kDegree;
  struct Rated {
    double explained;
    Eigen::Vector3d axis;
  };
  std::vector<Rated> rated;
  for (const Eigen::Vector3d& axis : hemisphere_directions()) {
    rated.push_back({shares_of(axis, normals).explained(), axis});
  }
  std::stable_sort(rated.begin(), rated.end(),
                   [](const Rated& a, const Rated& b) { return a.explained > b.explained; });
  std::vector<Eigen::Vector3d> starts;
  for (const Rated& r : rated) {
    const bool apart = std::all_of(starts.begin(), starts.end(), [&](const Eigen::Vector3d& other) {
      return std::abs(other.dot(r.axis)) < std::cos(kApart_rad);
    });
    if (apart) starts.push_back(r.axis);
    if (starts.size() == kMaxCount) break;
  }
  std::vector<Candidate> axes;
  for (const Eigen::Vector3d& start : starts) {
    const Candidate found = refined(start, normals);
    const bool is_new = std::all_of(axes.begin(), axes.end(), [&](const Candidate& other) {
      return std::abs(other.up.dot(found.up)) < std::cos(kApart_rad / 2);
    });
    if (is_new) axes.push_back(found);
  }
  return axes;
}

/// Mean and spread of a sample.
struct Spread {
  double mean = 0, sigma = 0;
};

Spread spread_of(const std::vector<double>& values) {
  Spread spread;
  double squares = 0;
  for (const double v : values) spread.mean += v / static_cast<double>(values.size());
  for (const double v : values) squares += (v - spread.mean) * (v - spread.mean);
  spread.sigma = std::sqrt(squares / static_cast<double>(values.size()));
  return spread;
}

/// Log density of a heavy-tailed distribution: no camera motion is impossible.
double heavy_tailed_log_density(double value, double sigma) {
  constexpr double kTail = 0.05;
  return std::log(std::exp(-value * value / (2 * sigma * sigma)) + kTail);
}

/// How people carry cameras: they look slightly down, pan and walk sideways more than they pitch and crouch,
/// and hold the camera without roll. The frames of a path are far from independent, so each cue counts once
/// for all frames.
double camera_evidence(const Eigen::Vector3d& up, std::span<const SE3> cameras) {
  constexpr double kPitch = -20 * kDegree, kPitchSigma = 30 * kDegree, kNodSigma = 20 * kDegree;
  constexpr double kRollSigma = 20 * kDegree;
  constexpr double kStoopSigma = 0.3;  // of the path's extent
  constexpr double kNoPath_m = 0.1;    // a shorter path means a camera held still
  constexpr double kPitchWeight = 2, kNodWeight = 1.5;
  if (cameras.empty()) return 0;
  std::vector<double> pitches, heights, rolls;
  std::array<std::vector<double>, 3> axes;
  for (const SE3& T_world_camera : cameras) {
    const Eigen::Vector3d in_camera = T_world_camera.rotation.conjugate() * up;
    pitches.push_back(std::asin(std::clamp(in_camera.z(), -1.0, 1.0)));
    heights.push_back(up.dot(T_world_camera.translation));
    for (int i = 0; i < 3; ++i) axes[static_cast<size_t>(i)].push_back(T_world_camera.translation[i]);
    // The vertical's image shrinks as the camera looks up or down, and roll becomes less meaningful.
    const double seen = in_camera.head<2>().norm();
    rolls.push_back(seen * heavy_tailed_log_density(std::atan2(in_camera.x(), -in_camera.y()), kRollSigma));
  }
  const Spread pitch = spread_of(pitches);
  double sum = spread_of(rolls).mean +
               kPitchWeight * heavy_tailed_log_density(pitch.mean - kPitch, kPitchSigma) +
               kNodWeight * heavy_tailed_log_density(pitch.sigma, kNodSigma);
  double extent = 0;
  for (const auto& axis : axes) extent = std::hypot(extent, spread_of(axis).sigma);
  if (extent > kNoPath_m) sum += heavy_tailed_log_density(spread_of(heights).sigma / extent, kStoopSigma);
  return sum;
}

/// Horizontal surfaces are mostly seen from above: floors, tables, seats. Walls are seen from both sides, or
/// by cameras that look along their normal, which rarely happens for long if the surface is a floor.
double surface_evidence(const Shares& shares) {
  constexpr double kNetWeight = 6, kNegligible = 0.1, kExplainedWeight = 10;
  const double net = (shares.above - shares.below) / (shares.above + shares.below + kNegligible);
  return kNetWeight * net + kExplainedWeight * shares.explained();
}

/// Returns the probability, among all candidates, of those near `direction`.
double probability_near(const Eigen::Vector3d& direction, const std::vector<Candidate>& candidates) {
  constexpr double kNear_rad = 45 * kDegree;  // as far as cameras look down
  double most = -std::numeric_limits<double>::infinity(), near = 0, all = 0;
  for (const Candidate& one : candidates) most = std::max(most, one.log_likelihood);
  for (const Candidate& one : candidates) {
    const double likelihood = std::exp(one.log_likelihood - most);
    all += likelihood;
    if (one.up.dot(direction) > std::cos(kNear_rad)) near += likelihood;
  }
  return all > 0 ? near / all : 0;
}

}  // namespace

const char* to_string(UpSource source) {
  if (source == UpSource::kGiven) return "given";
  return source == UpSource::kPlanes ? "planes" : "camera";
}

UpEstimate mean_camera_up(std::span<const SE3> T_world_cameras) {
  UpEstimate up;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SE3& pose : T_world_cameras) sum -= pose.R().col(1);
  if (!(sum.norm() > 0)) return up;
  up.direction = sum.normalized();
  up.confidence = sum.norm() / static_cast<double>(T_world_cameras.size());
  return up;
}

UpEstimate estimate_up_direction(std::span<const Eigen::Vector3f> normals,
                                 std::span<const SE3> T_world_cameras) {
  constexpr size_t kMinNormals = 300;     // with fewer, only part of an object was seen
  constexpr double kMinExplained = 0.35;  // twice the value of random directions
  constexpr double kMinUpright = 0.1;     // a single plane may as well be a wall
  constexpr double kMinConfidence = 0.6;
  UpEstimate fallback = mean_camera_up(T_world_cameras);
  const Normals some = chosen(normals);
  if (some.size() < kMinNormals) return fallback;

  std::vector<Candidate> candidates;
  for (const Candidate& candidate : best_axes(some)) {
    for (const double sign : {1.0, -1.0}) {
      Candidate& one = candidates.emplace_back(candidate);
      one.up *= sign;
      one.log_likelihood =
          surface_evidence(shares_of(one.up, some)) + camera_evidence(one.up, T_world_cameras);
    }
  }
  const auto best = std::max_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.log_likelihood < b.log_likelihood; });
  double sum = 0;
  for (const Candidate& one : candidates) sum += std::exp(one.log_likelihood - best->log_likelihood);
  const Shares shares = shares_of(best->up, some);
  const bool planes = best->determined && shares.explained() > kMinExplained && shares.upright > kMinUpright;
  if (!planes || 1 / sum < kMinConfidence) {
    fallback.confidence = std::min(fallback.confidence, probability_near(fallback.direction, candidates));
    return fallback;
  }
  return {best->up, UpSource::kPlanes, 1 / sum};
}

std::vector<SE3> camera_poses(const Trajectory& trajectory) {
  std::vector<SE3> poses;
  for (const StampedPose& pose : trajectory) poses.push_back(pose.T_world_camera);
  return poses;
}

Eigen::Quaterniond upright_rotation(const Eigen::Vector3d& up, const SE3& T_world_first) {
  const Eigen::Vector3d z = up.normalized();
  const Eigen::Matrix3d R = T_world_first.R();
  const auto along_floor = [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v - z * z.dot(v)); };
  constexpr double kTooSteep = 0.2;  // sine of the angle between viewing direction and vertical
  Eigen::Vector3d y = along_floor(R.col(2));
  if (y.norm() < kTooSteep) y = along_floor(-R.col(1));
  y.normalize();
  Eigen::Matrix3d axes;
  axes << y.cross(z).transpose(), y.transpose(), z.transpose();
  return Eigen::Quaterniond(axes).normalized();
}

}  // namespace kinloop
