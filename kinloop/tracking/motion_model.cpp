#include "kinloop/tracking/motion_model.hpp"

#include <algorithm>

#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

constexpr double kMaxCarriedS = 0.25;  // hands change direction within a few tenths of a second

}  // namespace

void MotionModel::update(const SE3& T_previous_current, int64_t duration_ns) {
  if (duration_ns <= 0) return;
  velocity_per_s_ = T_previous_current.log() / to_seconds(duration_ns);
}

SE3 MotionModel::predict(int64_t duration_ns) const {
  if (!velocity_per_s_) return {};
  return SE3::exp(*velocity_per_s_ * std::min(to_seconds(duration_ns), kMaxCarriedS));
}

}  // namespace kinloop
