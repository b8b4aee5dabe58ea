#include "kinloop/back_end/withdraw_keyframes.hpp"

#include <gtest/gtest.h>

#include "tests/back_end/steady_log.hpp"

namespace kinloop {
namespace {

/// Frames 40, 60 and 80 of 100 are keyframes 2, 3 and 4, too, to which the frames after them are relative.
class WithdrawKeyframes : public test::SteadyLog {
 protected:
  WithdrawKeyframes() : SteadyLog(100) {
    for (const uint32_t frame : {40U, 60U, 80U}) add_keyframe(frame);
  }

  void add_keyframe(uint32_t frame) {
    const SE3 T_world_keyframe({1, 0, 0, 0}, {x_m(frame), 0, 0});
    const KeyframeId id = map_.add_keyframe(log_[frame].id, log_[frame].stamp_ns, T_world_keyframe,
                                            std::make_shared<const Features>(), 0);
    log_[frame].keyframe = id;
    for (size_t i = frame; i < log_.size(); ++i) {
      log_[i].reference = id;
      log_[i].T_reference_camera.translation.x() = x_m(i) - x_m(frame);
    }
  }

  [[nodiscard]] std::vector<bool> withdrawn() const {
    std::vector<bool> all;
    for (const Keyframe& keyframe : map_.keyframes()) all.push_back(keyframe.withdrawn);
    return all;
  }
};

TEST_F(WithdrawKeyframes, TakesThoseOfTheFramesSinceThen) {
  EXPECT_EQ(withdraw_keyframes(50, 0, map_, log_), KeyframeId{2});
  EXPECT_EQ(withdrawn(), (std::vector<bool>{false, false, false, true, true}));
}

TEST_F(WithdrawKeyframes, KeepsThePosesInDoubtRelativeToTheLastKeyframeBefore) {
  withdraw_keyframes(50, 0, map_, log_);
  for (size_t i = 0; i < log_.size(); ++i) {
    EXPECT_NEAR(log_[i].world(map_).translation.x(), x_m(i), 1e-12) << i;
    EXPECT_EQ(log_[i].is_doubtful(), i >= 50) << i;
    EXPECT_LE(log_[i].reference.value, 2) << i;
  }
  EXPECT_EQ(log_[40].keyframe, KeyframeId{2});
  EXPECT_FALSE(log_[60].keyframe.valid());
}

TEST_F(WithdrawKeyframes, LeavesOtherComponentsAndLostFramesAlone) {
  for (size_t i = 90; i < 95; ++i) log_[i].reference = KeyframeId{1};
  log_[96].outcome = TrackingOutcome::kLost;
  withdraw_keyframes(50, 0, map_, log_);
  EXPECT_FALSE(log_[92].is_doubtful());
  EXPECT_EQ(log_[92].reference, KeyframeId{1});
  EXPECT_FALSE(log_[96].is_doubtful());
}

TEST_F(WithdrawKeyframes, TakesNothingIfNoneWasMade) {
  EXPECT_EQ(withdraw_keyframes(81, 0, map_, log_), std::nullopt);
  EXPECT_FALSE(log_[90].is_doubtful());
}

TEST_F(WithdrawKeyframes, KeepsAComponentThatHasNothingElse) {
  EXPECT_EQ(withdraw_keyframes(0, 0, map_, log_), std::nullopt);
  EXPECT_EQ(withdrawn(), std::vector<bool>(5, false));
}

}  // namespace
}  // namespace kinloop
