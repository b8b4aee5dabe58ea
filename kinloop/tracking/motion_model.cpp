#include "kinloop/tracking/motion_model.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

constexpr double kMaxCarried_s = 0.25;     // hands change direction within a few tenths of a second
constexpr double kMemory = 0.9;            // weight of the unrest so far against that of one more frame
constexpr double kUnknownSpeed_m_s = 0.5;  // 1 sigma of a hand of which nothing is known
constexpr double kUnknownTurn_rad_s = 1.0;

}  // namespace

void MotionModel::update(const SE3& T_previous_current, int64_t duration_ns) {
  if (duration_ns <= 0) return;
  const double duration_s = to_seconds(duration_ns);
  const Vector6d velocity = T_previous_current.log() / duration_s;
  if (velocity_per_s_) {
    const Vector6d change = velocity - *velocity_per_s_;
    const auto learn = [&](double so_far, const Eigen::Vector3d& axes) {
      return kMemory * so_far + (1 - kMemory) * axes.squaredNorm() / (3 * duration_s);
    };
    unrest_.of_shift = learn(unrest_.of_shift, change.head<3>());
    unrest_.of_turn = learn(unrest_.of_turn, change.tail<3>());
  }
  velocity_per_s_ = velocity;
}

PredictedPose MotionModel::predict(int64_t duration_ns) const {
  const double duration_s = to_seconds(duration_ns);
  if (!velocity_per_s_) return {{}, kUnknownSpeed_m_s * duration_s, kUnknownTurn_rad_s * duration_s};
  return {SE3::exp(*velocity_per_s_ * std::min(duration_s, kMaxCarried_s)),
          std::sqrt(unrest_.of_shift * duration_s) * duration_s,
          std::sqrt(unrest_.of_turn * duration_s) * duration_s};
}

}  // namespace kinloop
