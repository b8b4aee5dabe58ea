#include <algorithm>

#include <gtest/gtest.h>

#include "kinloop/back_end/final/final_pass.hpp"
#include "tests/back_end/steady_log.hpp"

namespace kinloop {
namespace {

class UnmeasuredFrames : public test::SteadyLog {
 protected:
  UnmeasuredFrames() : SteadyLog(120) {}

  void lose(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      log_[i].outcome = TrackingOutcome::kLost;
      log_[i].T_reference_camera = {};
    }
  }

  [[nodiscard]] FrameLog predicted(size_t first = 0, double max_sigma_m = 0.1) const {
    return predict_unmeasured_frames(log_, first, map_, max_sigma_m);
  }

  [[nodiscard]] size_t count_lost() const {
    return static_cast<size_t>(
        std::count_if(log_.begin(), log_.end(), [](const LoggedFrame& entry) { return entry.is_lost(); }));
  }
};

TEST_F(UnmeasuredFrames, BetweenGoodOnesArePredicted) {
  lose(40, 70);
  log_ = predicted();
  EXPECT_EQ(count_lost(), 0);
  for (size_t i = 40; i < 70; ++i) {
    EXPECT_FALSE(log_[i].is_doubtful());
    EXPECT_EQ(log_[i].method, TrackingMethod::kPredicted);
    EXPECT_NEAR(log_[i].world(map_).translation.x(), x_m(i), 1e-6) << i;
  }
  EXPECT_FALSE(log_[39].is_doubtful() || log_[70].is_doubtful());
  EXPECT_GT(position_sigma_m(log_[55].covariance), position_sigma_m(log_[41].covariance));
}

TEST_F(UnmeasuredFrames, AreDoubtfulWhereTheCameraMayBeFartherThanTheBound) {
  lose(40, 70);
  const double middle_m = position_sigma_m(predicted()[55].covariance);
  const FrameLog log = predicted(0, 0.7 * middle_m);
  EXPECT_FALSE(log[40].is_doubtful());
  EXPECT_EQ(log[55].trust.cause, DoubtCause::kUnmeasured);
  EXPECT_FALSE(log[69].is_doubtful());
}

TEST_F(UnmeasuredFrames, OfAFrozenImageDoNotKeepItsPose) {
  for (size_t i = 40; i < 70; ++i) {
    log_[i].method = TrackingMethod::kRepeat;
    log_[i].T_reference_camera = log_[39].T_reference_camera;
    doubt(log_[i], DoubtCause::kFrozen);
  }
  log_ = predicted();
  EXPECT_NEAR(log_[55].world(map_).translation.x(), x_m(55), 1e-6);
  EXPECT_FALSE(log_[55].is_doubtful());
}

TEST_F(UnmeasuredFrames, ConfirmARecognizedPlaceThatTheyExplain) {
  const LoggedFrame right = log_[55];
  lose(40, 70);
  for (const double off_m : {0.01, 0.5}) {
    log_[55] = right;
    log_[55].T_reference_camera.translation.y() += off_m;
    doubt(log_[55], DoubtCause::kPlace);
    const FrameLog log = predicted();
    EXPECT_EQ(log[55].is_doubtful(), off_m > 0.1);
    EXPECT_NEAR(log[55].world(map_).translation.y(), off_m, 1e-9) << "measured, not predicted";
    EXPECT_EQ(log[54].method, TrackingMethod::kPredicted);
    EXPECT_TRUE(predicted(0, 1e-3)[55].is_doubtful()) << "the prediction itself is uncertain";
  }
}

TEST_F(UnmeasuredFrames, ACameraThatShakesMayHaveGoneFarther) {
  lose(40, 70);
  const double steady_m = position_sigma_m(predicted()[55].covariance);
  for (size_t i = 0; i < 40; ++i) log_[i].T_reference_camera.translation.y() = i % 4 < 2 ? 0.02 : 0;
  EXPECT_GT(position_sigma_m(predicted()[55].covariance), 3 * steady_m);
}

TEST_F(UnmeasuredFrames, StayLostForMoreThanThreeSeconds) {
  lose(10, 105);
  EXPECT_EQ(predicted().at(50).outcome, TrackingOutcome::kLost);
}

TEST_F(UnmeasuredFrames, StayLostBetweenTwoComponents) {
  lose(40, 50);
  for (size_t i = 50; i < log_.size(); ++i) log_[i].reference = KeyframeId{1};
  log_ = predicted();
  EXPECT_EQ(count_lost(), 10);
}

TEST_F(UnmeasuredFrames, StayLostNextToDoubtfulOnesAndAtTheEnds) {
  lose(0, 5);
  lose(40, 50);
  lose(110, 120);
  doubt(log_[50], DoubtCause::kUnknown);
  log_ = predicted();
  EXPECT_EQ(count_lost(), 25);
}

TEST_F(UnmeasuredFrames, OfEarlierSessionsAreLeftAsTheyAre) {
  lose(40, 50);
  log_ = predicted(45);
  EXPECT_EQ(count_lost(), 10);
}

}  // namespace
}  // namespace kinloop
