// What spoils a recording, from the signs of its frames.

#include "session/input/recording_advisor.hpp"

#include <gmock/gmock.h>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using enum RecordingHint;

RecordingHints only(RecordingHint hint) {
  RecordingHints hints;
  return hints.set(static_cast<size_t>(hint));
}

/// Frames at 10 Hz.
class Filming {
 public:
  /// Adds frames with these signs for a time.
  void record(double seconds, const RecordingSigns& signs) {
    for (int i = 0; i < static_cast<int>(10 * seconds); ++i)
      advisor_.observe(stamp_ns_ += kNsPerSecond / 10, signs);
  }
  [[nodiscard]] std::vector<RecordingHint> hints() const { return advisor_.hints(); }
  [[nodiscard]] double seconds(RecordingHint hint) const { return advisor_.seconds(hint); }

 private:
  RecordingAdvisor advisor_;
  int64_t stamp_ns_ = 1'700'000'000 * kNsPerSecond;
};

constexpr RecordingSigns kGood{};
constexpr RecordingSigns kFast{.image_motion_rad_s = 3};
constexpr RecordingSigns kDark{.bright_level = 40};

TEST(Advice, AGoodFrameGetsNone) {
  EXPECT_TRUE(advice(kGood, {}).none());
}

TEST(Advice, EverySignHasItsHint) {
  EXPECT_EQ(advice({.in_doubt = true}, {}), only(kInDoubt));
  EXPECT_EQ(advice({.image_motion_rad_s = 3}, {}), only(kTooFast));
  EXPECT_EQ(advice({.depth_share = 0.1}, {}), only(kNoDepth));
  EXPECT_EQ(advice({.depth_m = 0.4}, {}), only(kTooNear));
  EXPECT_EQ(advice({.bright_level = 40}, {}), only(kTooDark));
  EXPECT_EQ(advice({.saturated_share = 0.6}, {}), only(kOverexposed));
  EXPECT_EQ(advice({.inliers = 12}, {}), only(kFewFeatures));
}

TEST(Advice, WithoutDepthNothingIsSaidOfItsDistance) {
  EXPECT_EQ(advice({.depth_share = 0, .depth_m = 0.4}, {}), only(kNoDepth));
}

TEST(Advice, AHintIsGivenUntilItsSignIsClearlyBetter) {
  const RecordingSigns between[] = {{.image_motion_rad_s = 1.65}, {.depth_share = 0.3},     {.depth_m = 0.65},
                                    {.bright_level = 100},        {.saturated_share = 0.2}, {.inliers = 45}};
  RecordingHints all;
  all.set();
  for (const RecordingSigns& signs : between) {
    EXPECT_TRUE(advice(signs, {}).none());
    EXPECT_EQ(advice(signs, all).count(), 1U);
  }
}

TEST(RecordingAdvisor, AHintWaitsForHalfASecondOfItsSigns) {
  Filming recording;
  recording.record(1, kGood);
  recording.record(0.4, kDark);
  EXPECT_THAT(recording.hints(), IsEmpty());
  recording.record(0.1, kGood);
  recording.record(0.4, kDark);
  EXPECT_THAT(recording.hints(), IsEmpty()) << "a pause begins it anew";
  recording.record(0.3, kDark);
  EXPECT_THAT(recording.hints(), ElementsAre(kTooDark));
}

TEST(RecordingAdvisor, SwingsAreShort) {
  Filming recording;
  recording.record(1, kGood);
  recording.record(0.2, kFast);
  EXPECT_THAT(recording.hints(), IsEmpty());
  recording.record(0.1, kFast);
  EXPECT_THAT(recording.hints(), ElementsAre(kTooFast));
}

TEST(RecordingAdvisor, AHintStaysForTwoSecondsAfterItsSigns) {
  Filming recording;
  recording.record(1, kFast);
  recording.record(1.9, kGood);
  recording.record(0.1, kFast);
  recording.record(1.9, kGood);
  EXPECT_THAT(recording.hints(), ElementsAre(kTooFast)) << "it does not flicker";
  recording.record(0.3, kGood);
  EXPECT_THAT(recording.hints(), IsEmpty());
}

TEST(RecordingAdvisor, ADoubtfulPoseIsToldAtOnce) {
  Filming recording;
  recording.record(1, kGood);
  recording.record(0.1, {.in_doubt = true});
  EXPECT_THAT(recording.hints(), ElementsAre(kInDoubt));
}

TEST(RecordingAdvisor, GivesTheMostUrgentThree) {
  Filming recording;
  recording.record(
      1, {.in_doubt = true, .image_motion_rad_s = 3, .depth_share = 0, .bright_level = 10, .inliers = 0});
  EXPECT_THAT(recording.hints(), ElementsAre(kInDoubt, kTooFast, kNoDepth));
  EXPECT_GT(recording.seconds(kFewFeatures), 0) << "but counts all";
}

TEST(RecordingAdvisor, CountsTheSecondsOfEachHint) {
  Filming recording;
  recording.record(5, kGood);
  EXPECT_EQ(recording.seconds(kTooFast), 0);
  recording.record(3, kFast);
  recording.record(5, kGood);
  EXPECT_NEAR(recording.seconds(kTooFast), 3 - 0.2 + 2, 0.11);
}

TEST(RecordingAdvisor, AGapCountsForASecondAtMost) {
  RecordingAdvisor advisor;
  advisor.observe(0, {.in_doubt = true});
  advisor.observe(3600 * kNsPerSecond, kGood);
  EXPECT_EQ(advisor.seconds(kInDoubt), 1);
}

/// A frame of one grey and one depth, but for a white left part and a right one without depth.
TrackedFrame frame_of(uint8_t gray, float depth_m, double white, double without_depth) {
  constexpr int kWidth = 160, kHeight = 120;
  auto frame = std::make_shared<Frame>();
  frame->gray = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(gray));
  frame->depth_m = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(depth_m));
  frame->gray.colRange(0, static_cast<int>(white * kWidth)).setTo(255);
  frame->depth_m.colRange(static_cast<int>((1 - without_depth) * kWidth), kWidth).setTo(0);
  TrackedFrame tracked;
  tracked.outcome = TrackingOutcome::kTracked;
  tracked.evidence.inliers = 120;
  tracked.frame = frame;
  return tracked;
}

TEST(RecordingSigns, OfImages) {
  const RecordingSigns signs = signs_of(frame_of(70, 1.5, 0, 0.25));
  EXPECT_EQ(signs.bright_level, 70);
  EXPECT_EQ(signs.saturated_share, 0);
  EXPECT_EQ(signs.depth_m, 1.5);
  EXPECT_EQ(signs.depth_share, 0.75);
  EXPECT_EQ(signs_of(frame_of(70, 1.5, 0.5, 0)).saturated_share, 0.5);
  EXPECT_EQ(signs_of(frame_of(70, 1.5, 0.5, 1)).depth_share, 0);
}

TEST(RecordingSigns, OfAPose) {
  TrackedFrame tracked = frame_of(150, 2, 0, 0);
  tracked.velocity = {{0, 0.6, 0.8}, {0.5, 0, 0}};
  RecordingSigns signs = signs_of(tracked);
  EXPECT_NEAR(signs.image_motion_rad_s, 0.5 + 1.0 / 2, 1e-9);
  EXPECT_EQ(signs.inliers, 120);
  EXPECT_FALSE(signs.in_doubt);
  doubt(tracked, DoubtCause::kUnknown);
  EXPECT_TRUE(signs_of(tracked).in_doubt);
  tracked.method = TrackingMethod::kDense;
  EXPECT_EQ(signs_of(tracked).inliers, 0) << "no landmark holds it";
  tracked.outcome = TrackingOutcome::kLost;
  signs = signs_of(tracked);
  EXPECT_TRUE(signs.in_doubt);
  EXPECT_EQ(signs.image_motion_rad_s, 0) << "unknown";
  EXPECT_EQ(advice(signs, {}), only(kInDoubt)) << "few landmarks would say the same";
}

}  // namespace
}  // namespace kinloop
