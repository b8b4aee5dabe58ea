#include "kinloop/map/frame_log.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

constexpr int kHeight_px = 480;

TrackedFrame logged(uint32_t id, TrackingOutcome outcome) {
  TrackedFrame entry;
  entry.id = FrameId{id};
  entry.outcome = outcome;
  entry.reference = KeyframeId{7};
  Frame frame;
  frame.id = entry.id;
  frame.features = std::make_shared<const Features>();
  if (entry.is_lost()) entry.frame = std::make_shared<const Frame>(frame);
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
                           [](const Frame&, const TrackedFrame&) { return located_at(4); }};
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackingOutcome::kTracked), logged(1, TrackingOutcome::kLost)}, kHeight_px, search);
  EXPECT_EQ(log[0].reference, KeyframeId{7});
  EXPECT_EQ(log[1].reference, KeyframeId{3});
  EXPECT_EQ(log[1].outcome, TrackingOutcome::kRelocalized);
}

TEST(RelocalizeLostFrames, ContinuesFromNeighborsInBothDirections) {
  // Frames 1 and 2 are found from 3 backwards, 4 and 5 from 3 forwards.
  std::vector<std::pair<uint32_t, uint32_t>> found;
  const FrameSearch search{nowhere, [&](const Frame& frame, const TrackedFrame& neighbor) {
                             found.emplace_back(frame.id.value, neighbor.id.value);
                             TrackedFrame tracked = located_at(7);
                             tracked.id = frame.id;
                             return tracked;
                           }};
  FrameLog log;
  for (uint32_t i = 0; i < 6; ++i)
    log.push_back(logged(i, i == 3 ? TrackingOutcome::kTracked : TrackingOutcome::kLost));
  log[0].frame = nullptr;  // nothing to search with
  log = relocalize_lost_frames(std::move(log), kHeight_px, search);
  EXPECT_EQ(found, (std::vector<std::pair<uint32_t, uint32_t>>{{2, 3}, {1, 2}, {4, 3}, {5, 4}}));
  for (size_t i = 1; i < log.size(); ++i) EXPECT_FALSE(log[i].is_lost()) << i;
  EXPECT_TRUE(log[0].is_lost());
}

TEST(RelocalizeLostFrames, KeepsFramesLostThatAreNotFound) {
  const FrameSearch search{
      nowhere, [](const Frame&, const TrackedFrame&) -> std::optional<TrackedFrame> { return {}; }};
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackingOutcome::kTracked), logged(1, TrackingOutcome::kLost)}, kHeight_px, search);
  EXPECT_TRUE(log[1].is_lost());
  EXPECT_TRUE(log[1].frame) << "may be searched again";
}

}  // namespace
}  // namespace kinloop
