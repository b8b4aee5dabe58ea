#include "kinloop/map/frames/frame_log.hpp"

#include <set>
#include <string_view>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

constexpr int kHeight_px = 480;

LoggedFrame logged(uint32_t id, TrackingOutcome outcome) {
  LoggedFrame entry;
  entry.id = FrameId{id};
  entry.outcome = outcome;
  entry.reference = KeyframeId{7};
  Frame frame;
  frame.id = entry.id;
  frame.features = std::make_shared<const Features>();
  if (entry.is_lost()) entry.lost = std::make_shared<const Frame>(frame);
  return entry;
}

TrackedFrame located_at(uint32_t reference) {
  TrackedFrame tracked;
  tracked.outcome = TrackingOutcome::kRelocalized;
  tracked.reference = KeyframeId{reference};
  return tracked;
}

std::optional<TrackedFrame> nowhere(const Frame&) {
  return std::nullopt;
}

TEST(RelocalizeLostFrames, SearchesAnywhereFirst) {
  const FrameSearch search{[](const Frame&) { return located_at(3); },
                           [](const Frame&, const FrameRecord&) { return located_at(4); }};
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackingOutcome::kTracked), logged(1, TrackingOutcome::kLost)}, kHeight_px, search);
  EXPECT_EQ(log[0].reference, KeyframeId{7});
  EXPECT_EQ(log[1].reference, KeyframeId{3});
  EXPECT_EQ(log[1].outcome, TrackingOutcome::kRelocalized);
}

TEST(RelocalizeLostFrames, ContinuesFromNeighborsInBothDirections) {
  // Frames 1 and 2 are found from 3 backwards, 4 and 5 from 3 forwards.
  std::vector<std::pair<uint32_t, uint32_t>> found;
  const FrameSearch search{nowhere, [&](const Frame& frame, const FrameRecord& neighbor) {
                             found.emplace_back(frame.id.value, neighbor.id.value);
                             TrackedFrame tracked = located_at(7);
                             tracked.id = frame.id;
                             return tracked;
                           }};
  FrameLog log;
  for (uint32_t i = 0; i < 6; ++i)
    log.push_back(logged(i, i == 3 ? TrackingOutcome::kTracked : TrackingOutcome::kLost));
  log[0].lost = nullptr;  // nothing to search with
  log = relocalize_lost_frames(std::move(log), kHeight_px, search);
  EXPECT_EQ(found, (std::vector<std::pair<uint32_t, uint32_t>>{{2, 3}, {1, 2}, {4, 3}, {5, 4}}));
  ASSERT_EQ(log.size(), 6U);
  for (size_t i = 1; i < log.size(); ++i) EXPECT_FALSE(log[i].is_lost()) << i;
  EXPECT_TRUE(log[0].is_lost());
}

TEST(RelocalizeLostFrames, KeepsTheDoubtOfWhatWasFound) {
  const FrameSearch search{[](const Frame& frame) -> std::optional<TrackedFrame> {
                             TrackedFrame tracked = located_at(3);
                             if (frame.id == FrameId{1}) doubt(tracked, DoubtCause::kUnknown);
                             return tracked;
                           },
                           [](const Frame&, const FrameRecord&) { return located_at(4); }};
  const FrameLog log = relocalize_lost_frames(
      {logged(1, TrackingOutcome::kLost), logged(2, TrackingOutcome::kLost)}, kHeight_px, search);
  EXPECT_TRUE(log[0].is_doubtful());
  EXPECT_FALSE(log[1].is_doubtful());
}

TEST(RelocalizeLostFrames, WhatIsFoundWithoutDepthIsInDoubt) {
  const FrameSearch search{nowhere, [](const Frame&, const FrameRecord&) { return located_at(4); }};
  LoggedFrame without_depth = logged(1, TrackingOutcome::kLost);
  without_depth.evidence.input.depth_factor = 0;
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackingOutcome::kTracked), without_depth, logged(2, TrackingOutcome::kLost)}, kHeight_px,
      search);
  EXPECT_TRUE(log[1].is_doubtful());
  EXPECT_EQ(log[1].evidence.input.depth_factor, 0);
  EXPECT_FALSE(log[2].is_doubtful());
}

/// A map of one keyframe, and frames of which `doubtful` are in doubt.
class DoubtfulFrames : public testing::Test {
 protected:
  DoubtfulFrames() {
    map_.add_keyframe(FrameId{0}, 0, SE3(), std::make_shared<const Features>(), 0);
    for (uint32_t i = 0; i < 5; ++i) {
      LoggedFrame entry;
      entry.id = FrameId{i};
      entry.stamp_ns = i;
      entry.outcome = i == 4 ? TrackingOutcome::kLost : TrackingOutcome::kTracked;
      entry.reference = KeyframeId{0};
      log_.push_back(entry);
    }
  }

  Map map_;
  FrameLog log_;
};

TEST_F(DoubtfulFrames, AreInATrajectoryOnlyOnRequest) {
  for (const size_t i : {1, 2, 4}) doubt(log_[i], DoubtCause::kUnknown);
  const Trajectory trusted = trajectory_of(log_, map_);
  ASSERT_EQ(trusted.size(), 2U);
  EXPECT_EQ(trusted[1].stamp_ns, 3);
  EXPECT_EQ(trajectory_of(log_, map_, DoubtfulPoses::kKept).size(), 4U) << "all but the lost one";
  EXPECT_EQ(note_on_doubtful_poses(log_, map_, DoubtfulPoses::kLeftOut), "2 doubtful poses left out");
  EXPECT_EQ(note_on_doubtful_poses(log_, map_, DoubtfulPoses::kKept), "with 2 doubtful poses");
}

TEST_F(DoubtfulFrames, AreNotedOnlyIfThereAreSome) {
  EXPECT_EQ(note_on_doubtful_poses(log_, map_, DoubtfulPoses::kLeftOut), "");
  doubt(log_[3], DoubtCause::kUnknown);
  EXPECT_EQ(note_on_doubtful_poses(log_, map_, DoubtfulPoses::kKept), "with 1 doubtful pose");
}

TEST(Doubt, HasItsFirstCauseUnlessThatIsOnlyWeakEvidence) {
  FrameRecord frame;
  doubt(frame, DoubtCause::kNone);
  EXPECT_FALSE(frame.is_doubtful());
  doubt(frame, DoubtCause::kFewLandmarks);
  doubt(frame, DoubtCause::kDrift);
  doubt(frame, DoubtCause::kNone);
  EXPECT_EQ(frame.trust.cause, DoubtCause::kFewLandmarks);
  doubt(frame, DoubtCause::kSurfaces);
  doubt(frame, DoubtCause::kPlace);
  EXPECT_EQ(frame.trust.cause, DoubtCause::kSurfaces);
}

TEST(Doubt, EveryCauseHasANameAndANumber) {
  std::set<std::string_view> names;
  int64_t number = 0;
  for (; const auto cause = doubt_cause(number); ++number) names.insert(name_of(*cause));
  EXPECT_EQ(names.size(), static_cast<size_t>(number));
  EXPECT_EQ(doubt_cause(number - 1), DoubtCause::kNeighbours) << "the last one";
  EXPECT_FALSE(doubt_cause(-1));
}

TEST(LogEntry, KeepsTheDoubt) {
  TrackedFrame tracked = located_at(1);
  Frame frame;
  frame.features = std::make_shared<const Features>();
  tracked.frame = std::make_shared<const Frame>(frame);
  doubt(tracked, DoubtCause::kUnknown);
  EXPECT_TRUE(log_entry(tracked, kHeight_px).is_doubtful());
}

TEST(RelocalizeLostFrames, KeepsFramesLostThatAreNotFound) {
  const FrameSearch search{
      nowhere, [](const Frame&, const FrameRecord&) -> std::optional<TrackedFrame> { return {}; }};
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackingOutcome::kTracked), logged(1, TrackingOutcome::kLost)}, kHeight_px, search);
  EXPECT_TRUE(log[1].is_lost());
  EXPECT_TRUE(log[1].lost) << "may be searched again";
}

TEST(Covariances, AreThoseOfThePosesOfTheTrajectory) {
  Map map;
  map.add_keyframe(FrameId{0}, 0, {}, std::make_shared<const Features>());
  FrameLog log(5);
  for (LoggedFrame& entry : log) {
    entry.outcome = TrackingOutcome::kTracked;
    entry.reference = KeyframeId{0};
  }
  for (size_t i = 0; i < log.size(); ++i) {
    log[i].stamp_ns = static_cast<int64_t>(i);
    log[i].world_covariance = static_cast<double>(i) * Matrix6d::Identity();
  }
  log[1].outcome = TrackingOutcome::kLost;
  doubt(log[3], DoubtCause::kUnknown);
  for (const DoubtfulPoses doubtful : {DoubtfulPoses::kLeftOut, DoubtfulPoses::kKept}) {
    const Trajectory trajectory = trajectory_of(log, map, doubtful);
    const auto covariances = covariances_of(log, map, doubtful);
    ASSERT_EQ(covariances.size(), trajectory.size());
    ASSERT_EQ(covariances.size(), doubtful == DoubtfulPoses::kKept ? 4U : 3U);
    EXPECT_FALSE(covariances[0]);  // zero: unknown
    for (size_t i = 1; i < covariances.size(); ++i)
      EXPECT_EQ((*covariances[i])(0, 0), static_cast<double>(trajectory[i].stamp_ns));
  }
}

}  // namespace
}  // namespace kinloop
