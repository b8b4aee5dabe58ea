#include "session/run_quality.hpp"

#include <gmock/gmock.h>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kRate_hz = 10;

/// Trusted frames at 10 Hz.
std::vector<JudgedFrame> frames(size_t count) {
  std::vector<JudgedFrame> all;
  for (size_t i = 0; i < count; ++i) {
    const auto stamp_ns = static_cast<int64_t>(static_cast<double>(i) / kRate_hz * kNsPerSecond);
    all.push_back({5 * kNsPerSecond + stamp_ns, FrameTrust::kTrusted});
  }
  return all;
}

/// The same, of which [from, to) have another trust.
std::vector<JudgedFrame> frames(size_t count, FrameTrust trust, size_t from, size_t to) {
  auto all = frames(count);
  for (size_t i = from; i < to; ++i) all[i].trust = trust;
  return all;
}

TEST(RunQuality, IsGoodIfEveryFrameCanBeTrusted) {
  const RunQuality quality = judge(frames(100));
  EXPECT_EQ(quality.verdict, Verdict::kGood);
  EXPECT_NEAR(quality.seconds, 10, 1e-9);
  EXPECT_EQ(quality.seconds_doubtful, 0);
  EXPECT_EQ(quality.seconds_lost, 0);
  EXPECT_THAT(quality.reasons, IsEmpty());
}

TEST(RunQuality, DependsOnTheShareOfTheTimeInDoubtOrLost) {
  for (const FrameTrust trust : {FrameTrust::kDoubtful, FrameTrust::kLost, FrameTrust::kElsewhere}) {
    EXPECT_EQ(judge(frames(1000, trust, 500, 504)).verdict, Verdict::kGood);
    EXPECT_EQ(judge(frames(1000, trust, 500, 506)).verdict, Verdict::kDoubtful);
    EXPECT_EQ(judge(frames(1000, trust, 500, 699)).verdict, Verdict::kDoubtful);
    EXPECT_EQ(judge(frames(1000, trust, 500, 701)).verdict, Verdict::kBad);
  }
}

TEST(RunQuality, AddsUpDoubtAndLoss) {
  auto mixed = frames(1000, FrameTrust::kDoubtful, 100, 250);
  for (size_t i = 600; i < 660; ++i) mixed[i].trust = FrameTrust::kLost;
  const RunQuality quality = judge(mixed);
  EXPECT_EQ(quality.verdict, Verdict::kBad);
  EXPECT_NEAR(quality.seconds_doubtful, 15, 1e-6);
  EXPECT_NEAR(quality.seconds_lost, 6, 1e-6);
}

TEST(RunQuality, NamesTheLongestStretchSinceTheFirstFrame) {
  auto mixed = frames(333, FrameTrust::kDoubtful, 100, 110);
  for (size_t i = 200; i < 222; ++i) mixed[i].trust = FrameTrust::kDoubtful;
  mixed[0].trust = FrameTrust::kLost;
  mixed[332].trust = FrameTrust::kElsewhere;
  EXPECT_THAT(judge(mixed).reasons,
              ElementsAre("3.2 s of 33.3 s are in doubt (longest: 20.0 s to 22.2 s)",
                          "0.1 s of 33.3 s are lost (longest: 0.0 s to 0.1 s)",
                          "0.1 s of 33.3 s are in other components of the map (longest: 33.2 s to 33.3 s)"));
}

TEST(RunQuality, DoesNotBlameAFrameForAPauseOfTheCamera) {
  auto paused = frames(100, FrameTrust::kLost, 49, 50);
  for (size_t i = 50; i < 100; ++i) paused[i].stamp_ns += 600 * kNsPerSecond;
  EXPECT_NEAR(judge(paused).seconds_lost, 1, 1e-9);
}

TEST(RunQuality, IsBadWithoutFramesAndKnownWithOne) {
  EXPECT_EQ(judge({}).verdict, Verdict::kBad);
  EXPECT_THAT(judge({}).reasons, ElementsAre("there are no frames"));
  EXPECT_EQ(judge(frames(1)).verdict, Verdict::kGood);
  EXPECT_EQ(judge(frames(1, FrameTrust::kLost, 0, 1)).verdict, Verdict::kBad);
}

TEST(RunQuality, JudgesTheFramesOfALog) {
  Map map;
  const auto features = std::make_shared<const Features>();
  map.add_keyframe(FrameId{0}, 0, SE3(), features, 0);
  map.add_keyframe(FrameId{4}, 4, SE3(), features, 1);
  FrameLog log(5);
  for (uint32_t i = 0; i < 5; ++i) {
    log[i].stamp_ns = i;
    log[i].outcome = TrackingOutcome::kTracked;
    log[i].reference = KeyframeId{i == 4 ? 1U : 0U};
  }
  for (const size_t i : {2, 3}) doubt(log[i], DoubtCause::kUnknown);
  log[3].outcome = TrackingOutcome::kLost;
  std::vector<FrameTrust> trust;
  for (const JudgedFrame& frame : judged_frames(log, map)) trust.push_back(frame.trust);
  EXPECT_THAT(trust, ElementsAre(FrameTrust::kTrusted, FrameTrust::kTrusted, FrameTrust::kDoubtful,
                                 FrameTrust::kLost, FrameTrust::kElsewhere));
}

TEST(RunQuality, TellsWhatWasLeftOutOfTheImage) {
  auto all = frames(100);
  for (size_t i = 0; i < 50; ++i) all[i].fixed_share = 0.25;
  for (size_t i = 60; i < 72; ++i) all[i].moved_share = i == 65 ? 0.4 : 0.1;
  const RunQuality quality = judge(all);
  EXPECT_EQ(quality.verdict, Verdict::kGood);  // the poses can be trusted all the same
  EXPECT_THAT(
      quality.reasons,
      ElementsAre("something moves with the camera for 5.0 s, up to 25 % of the image; it is left out",
                  "something else moves for 1.2 s, up to 40 % of the image; it is left out"));
}

TEST(RunQuality, TellsWhatWasWrongWithDepth) {
  auto all = frames(100);
  for (size_t i = 20; i < 50; ++i) all[i].depth_factor = 0;
  for (size_t i = 60; i < 100; ++i) all[i].depth_factor = 1 / 0.9;
  EXPECT_THAT(
      judge(all).reasons,
      ElementsAre("from 6.0 s on all depths are 0.900 of what they were at first; they are scaled back",
                  "depth is frozen or missing for 3.0 s"));
}

TEST(RunQuality, AMomentIsNotWorthAReason) {
  auto all = frames(100);
  for (size_t i = 60; i < 65; ++i) all[i].moved_share = 0.1;
  EXPECT_THAT(judge(all).reasons, IsEmpty());
}

TEST(RunQuality, IsNotGoodIfTheUnitOfDepthIsGuessed) {
  const RunQuality good = judge(frames(100));
  EXPECT_EQ(with_guessed_unit(good, "").verdict, Verdict::kGood);
  const RunQuality guessed = with_guessed_unit(good, "nobody states the unit");
  EXPECT_EQ(guessed.verdict, Verdict::kDoubtful);
  EXPECT_EQ(guessed.reasons.back(), "nobody states the unit");
}

}  // namespace
}  // namespace kinloop
