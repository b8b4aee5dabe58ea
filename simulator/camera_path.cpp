#include "simulator/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kRate_hz = 60, kFirstStamp_s = 1, kHandHeight_m = 1.45;  // of the built-in paths

/// 3 s^2 - 2 s^3: from 0 to 1 with zero slope at the ends.
double smoothstep(double s) {
  return s * s * (3 - 2 * s);
}

/// A sum of slow sine waves that imitates a hand: amplitude falls faster than frequency rises.
class SmoothNoise {
 public:
  SmoothNoise(double amplitude, Random& random) {
    constexpr double kFrequencies_hz[] = {0.31, 0.53, 0.97, 1.83};
    constexpr double kDecay = 1.3;
    for (const double frequency_hz : kFrequencies_hz) {
      swings_.push_back({amplitude * std::pow(kFrequencies_hz[0] / frequency_hz, kDecay),
                         2 * kPi * frequency_hz, random.uniform(0, 2 * kPi)});
    }
  }
  [[nodiscard]] double at(double time_s) const {
    double sum = 0;
    for (const Swing& swing : swings_) sum += swing.amplitude * std::sin(swing.rate * time_s + swing.phase);
    return sum;
  }

 private:
  struct Swing {
    double amplitude, rate, phase;
  };
  std::vector<Swing> swings_;
};

/// How a walking person's hand moves a camera.
struct Hand {
  explicit Hand(Random& random)
      : x(0.03, random),
        y(0.03, random),
        z(0.022, random),
        yaw(5 * kDegree, random),
        pitch(4 * kDegree, random),
        roll(1.5 * kDegree, random) {}

  SmoothNoise x, y, z, yaw, pitch, roll;
};

/// The direction of an angle about the vertical and one above the horizontal.
Eigen::Vector3d direction(double heading_rad, double slope_rad) {
  return {std::cos(slope_rad) * std::cos(heading_rad), std::cos(slope_rad) * std::sin(heading_rad),
          std::sin(slope_rad)};
}

/// Camera at `position` looking along `forward`, rolled by `roll_rad`; z is up.
SE3 looking(const Eigen::Vector3d& position, const Eigen::Vector3d& forward, double roll_rad) {
  Eigen::Matrix3d R;
  R.col(2) = forward.normalized();
  R.col(0) = R.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  const Eigen::AngleAxisd roll(roll_rad, Eigen::Vector3d::UnitZ());
  return {Eigen::Quaterniond(R * roll.toRotationMatrix()).normalized(), position};
}

/// Returns whether the cameras look neither up nor straight down if z is up, as in motion-capture worlds;
/// false if the world is the first camera's frame.
bool z_is_plausibly_up(const Trajectory& poses) {
  constexpr double kMaxDown = -0.9, kMaxUp = 0.5, kFirst_rad = 1e-3;
  double mean = 0;
  for (const StampedPose& pose : poses) {
    mean += pose.T_world_camera.R()(2, 2) / static_cast<double>(poses.size());
  }
  return mean > kMaxDown && mean < kMaxUp && poses.front().T_world_camera.angle_rad() > kFirst_rad;
}

}  // namespace

CameraPath::CameraPath(Trajectory poses) : poses_(std::move(poses)) {
  require(!poses_.empty(), "a camera path needs a pose");
  const auto repeats = [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns == b.stamp_ns; };
  poses_.erase(std::unique(poses_.begin(), poses_.end(), repeats), poses_.end());
  twist_per_s_.resize(poses_.size(), Vector6d::Zero());
  for (size_t i = 0; i < poses_.size(); ++i) {
    const StampedPose& before = poses_[i == 0 ? 0 : i - 1];
    const StampedPose& after = poses_[std::min(i + 1, poses_.size() - 1)];
    if (before.stamp_ns == after.stamp_ns) continue;
    const SE3 motion = before.T_world_camera.inverse() * after.T_world_camera;
    twist_per_s_[i] = motion.log() / to_seconds(after.stamp_ns - before.stamp_ns);
  }
}

SE3 CameraPath::extrapolated(size_t index, int64_t stamp_ns) const {
  const double elapsed_s = to_seconds(stamp_ns - poses_[index].stamp_ns);
  return poses_[index].T_world_camera * SE3::exp(elapsed_s * twist_per_s_[index]);
}

SE3 CameraPath::at(int64_t stamp_ns) const {
  const auto later = std::upper_bound(poses_.begin(), poses_.end(), stamp_ns,
                                      [](int64_t stamp, const StampedPose& p) { return stamp < p.stamp_ns; });
  if (later == poses_.begin()) return extrapolated(0, stamp_ns);
  if (later == poses_.end()) return extrapolated(poses_.size() - 1, stamp_ns);
  const auto after = static_cast<size_t>(later - poses_.begin());
  const int64_t begin = poses_[after - 1].stamp_ns, end = poses_[after].stamp_ns;
  const double s = static_cast<double>(stamp_ns - begin) / static_cast<double>(end - begin);
  // Blends the motions at both neighbours; each end keeps its pose and velocity.
  return interpolate(extrapolated(after - 1, stamp_ns), extrapolated(after, stamp_ns), smoothstep(s));
}

Trajectory handheld_path(uint64_t seed, double seconds) {
  constexpr double kDuration_s = 18.7;
  constexpr double kRadius_x_m = 1.45, kRadius_y_m = 1.0;
  constexpr double kOverlap_rad = 0.3;
  Random random(hash(seed, 0x9a7b));
  const Hand hand(random);
  const double start_rad = random.uniform(0, 2 * kPi);
  Trajectory poses;
  const int count = static_cast<int>((seconds > 0 ? seconds : kDuration_s) * kRate_hz);
  for (int i = 0; i <= count; ++i) {
    const double t = i / kRate_hz;
    const double turn = start_rad + (2 * kPi + kOverlap_rad) * t / kDuration_s;
    const Eigen::Vector3d position(kRadius_x_m * std::cos(turn) + hand.x.at(t),
                                   kRadius_y_m * std::sin(turn) + hand.y.at(t), kHandHeight_m + hand.z.at(t));
    // Looks outwards and slightly ahead and down, at times up the walls and down to the floor.
    const double heading =
        turn + 20 * kDegree + hand.yaw.at(t) + 9 * kDegree * std::sin(4.3 * (turn - start_rad));
    const double slope = -13 * kDegree + hand.pitch.at(t) + 7 * kDegree * std::sin(3 * (turn - start_rad));
    poses.push_back(
        {to_ns(t + kFirstStamp_s), looking(position, direction(heading, slope), hand.roll.at(t))});
  }
  return poses;
}

Trajectory corridor_path(uint64_t seed, double seconds) {
  constexpr double kLength_m = 14, kPace_m_s = 0.9, kTurn_s = 3, kLeg_s = kLength_m / kPace_m_s;
  constexpr double kAside_rad = 40 * kDegree, kAsidePeriod_s = 5;
  Random random(hash(seed, 0x9a7c));
  const Hand hand(random);
  Trajectory poses;
  const int count = static_cast<int>((seconds > 0 ? seconds : 2 * kLeg_s + kTurn_s) * kRate_hz);
  for (int i = 0; i <= count; ++i) {
    const double t = i / kRate_hz;
    const double in_round_s = std::fmod(t, 2 * (kLeg_s + kTurn_s));
    const bool back = in_round_s > kLeg_s + kTurn_s;
    const double in_leg_s = back ? in_round_s - kLeg_s - kTurn_s : in_round_s;
    const double walked = std::min(in_leg_s / kLeg_s, 1.0);
    const double turned = smoothstep(std::clamp((in_leg_s - kLeg_s) / kTurn_s, 0.0, 1.0));
    const Eigen::Vector3d position((back ? 0.5 - walked : walked - 0.5) * kLength_m + hand.x.at(t),
                                   hand.y.at(t), kHandHeight_m + hand.z.at(t));
    const double heading = kPi * (turned + (back ? 1 : 0)) + hand.yaw.at(t) +
                           kAside_rad * std::sin(2 * kPi * t / kAsidePeriod_s);
    const double slope = -8 * kDegree + hand.pitch.at(t);
    poses.push_back(
        {to_ns(t + kFirstStamp_s), looking(position, direction(heading, slope), hand.roll.at(t))});
  }
  return poses;
}

Eigen::Vector3d estimate_up_direction(const Trajectory& poses) {
  constexpr double kMinSpread = 0.1;    // of the right axes about the vertical
  constexpr double kMaxTilt_rad = 0.7;  // between the level estimate and the mean -y axis
  constexpr double kSnap_rad = 0.2;
  constexpr double kMaxRoll = 0.03;  // of the right axes along the vertical: 10 degrees
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_up = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : poses) {
    const Eigen::Matrix3d R = pose.T_world_camera.R();
    spread += R.col(0) * R.col(0).transpose() / static_cast<double>(poses.size());
    mean_up -= R.col(1);
  }
  const Eigen::Vector3d up = mean_up.normalized();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  Eigen::Vector3d level = axes.eigenvectors().col(0);
  if (level.dot(up) < 0) level = -level;
  const bool told = axes.eigenvalues()(0) < kMaxRoll && axes.eigenvalues()(1) > kMinSpread &&
                    level.dot(up) > std::cos(kMaxTilt_rad);
  // A camera may be rolled by any angle, even a changing one, but z rarely points down.
  if (told ? level.z() < -std::cos(kSnap_rad) : z_is_plausibly_up(poses)) return Eigen::Vector3d::UnitZ();
  int axis = 0;
  (told ? level : up).cwiseAbs().maxCoeff(&axis);
  const Eigen::Vector3d nearest = Eigen::Vector3d::Unit(axis) * (up[axis] < 0 ? -1 : 1);
  return told && level.dot(nearest) < std::cos(kSnap_rad) ? level : nearest;
}

std::vector<int64_t> frame_stamps(const Trajectory& poses, double fps) {
  std::vector<int64_t> stamps;
  if (fps <= 0) {
    for (const StampedPose& pose : poses) {
      if (stamps.empty() || pose.stamp_ns > stamps.back()) stamps.push_back(pose.stamp_ns);
    }
    return stamps;
  }
  constexpr double kMaxDuration_s = 24 * 3600;
  if (to_seconds(poses.back().stamp_ns) - to_seconds(poses.front().stamp_ns) > kMaxDuration_s) {
    throw InputError(fmt::format(
        "the path lasts from {} to {} s, but simulated paths may last at most a day: correct its timestamps",
        format_stamp(poses.front().stamp_ns), format_stamp(poses.back().stamp_ns)));
  }
  const double duration_s = to_seconds(poses.back().stamp_ns - poses.front().stamp_ns);
  constexpr int64_t kMicrosecond_ns = 1000;  // time resolution of sequence files
  for (int i = 0; i / fps <= duration_s; ++i) {
    const int64_t since_ns = to_ns(i / fps);
    stamps.push_back(poses.front().stamp_ns +
                     (since_ns + kMicrosecond_ns / 2) / kMicrosecond_ns * kMicrosecond_ns);
  }
  return stamps;
}

}  // namespace kinloop::sim
