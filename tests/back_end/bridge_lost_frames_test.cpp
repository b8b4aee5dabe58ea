#include <algorithm>

#include <gtest/gtest.h>

#include "kinloop/back_end/final/final_pass.hpp"
#include "tests/back_end/steady_log.hpp"

namespace kinloop {
namespace {

class LostFrames : public test::SteadyLog {
 protected:
  LostFrames() : SteadyLog(120) {}

  void lose(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      log_[i].outcome = TrackingOutcome::kLost;
      log_[i].T_reference_camera = {};
    }
  }

  [[nodiscard]] size_t count_lost() const {
    return static_cast<size_t>(
        std::count_if(log_.begin(), log_.end(), [](const LoggedFrame& entry) { return entry.is_lost(); }));
  }
};

TEST_F(LostFrames, BetweenGoodOnesAreBridgedInDoubt) {
  lose(40, 70);
  log_ = bridge_lost_frames(log_, 0, map_);
  EXPECT_EQ(count_lost(), 0);
  for (size_t i = 40; i < 70; ++i) {
    EXPECT_TRUE(log_[i].doubtful);
    EXPECT_FALSE(log_[i].is_tracked_by_landmarks());
    EXPECT_NEAR(log_[i].world(map_).translation.x(), x_m(i), 1e-6) << i;
  }
  EXPECT_FALSE(log_[39].doubtful || log_[70].doubtful);
  EXPECT_GT(position_sigma_m(log_[55].covariance), position_sigma_m(log_[41].covariance));
}

TEST_F(LostFrames, ACameraThatShakesMayHaveGoneFarther) {
  lose(40, 70);
  const double steady_m = position_sigma_m(bridge_lost_frames(log_, 0, map_)[55].covariance);
  for (size_t i = 0; i < 40; ++i) log_[i].T_reference_camera.translation.y() = i % 4 < 2 ? 0.02 : 0;
  EXPECT_GT(position_sigma_m(bridge_lost_frames(log_, 0, map_)[55].covariance), 3 * steady_m);
}

TEST_F(LostFrames, StayLostForMoreThanThreeSeconds) {
  lose(10, 105);
  EXPECT_EQ(bridge_lost_frames(log_, 0, map_).at(50).outcome, TrackingOutcome::kLost);
}

TEST_F(LostFrames, StayLostBetweenTwoComponents) {
  lose(40, 50);
  for (size_t i = 50; i < log_.size(); ++i) log_[i].reference = KeyframeId{1};
  log_ = bridge_lost_frames(log_, 0, map_);
  EXPECT_EQ(count_lost(), 10);
}

TEST_F(LostFrames, StayLostNextToDoubtfulOnesAndAtTheEnds) {
  lose(0, 5);
  lose(40, 50);
  lose(110, 120);
  log_[50].doubtful = true;
  log_ = bridge_lost_frames(log_, 0, map_);
  EXPECT_EQ(count_lost(), 25);
}

TEST_F(LostFrames, OfEarlierSessionsAreLeftAsTheyAre) {
  lose(40, 50);
  log_ = bridge_lost_frames(log_, 45, map_);
  EXPECT_EQ(count_lost(), 10);
}

}  // namespace
}  // namespace kinloop
