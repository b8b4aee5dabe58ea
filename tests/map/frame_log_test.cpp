#include "kinloop/tracking/frame_log.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

constexpr int kHeight_px = 480;

LoggedFrame logged(uint32_t frame, TrackStatus status) {
  LoggedFrame entry;
  entry.frame = FrameId{frame};
  entry.status = status;
  entry.reference = KeyframeId{7};
  if (status == TrackStatus::kLost) entry.features = std::make_shared<const Features>();
  return entry;
}

TrackResult located_at(uint32_t reference) {
  TrackResult result;
  result.status = TrackStatus::kTracked;
  result.reference = KeyframeId{reference};
  return result;
}

std::optional<TrackResult> nowhere(const PreparedFrame&) {
  return std::nullopt;
}

TEST(RelocalizeLostFrames, SearchesAnywhereFirst) {
  const FrameSearch search{[](const PreparedFrame&) { return located_at(3); },
                           [](const PreparedFrame&, const LoggedFrame&) { return located_at(4); }};
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackStatus::kTracked), logged(1, TrackStatus::kLost)}, kHeight_px, search);
  EXPECT_EQ(log[0].reference, KeyframeId{7});
  EXPECT_EQ(log[1].reference, KeyframeId{3});
  EXPECT_EQ(log[1].status, TrackStatus::kTracked);
}

TEST(RelocalizeLostFrames, ContinuesFromNeighborsInBothDirections) {
  // Frames 1 and 2 are found from 3 backwards, 4 and 5 from 3 forwards.
  std::vector<std::pair<uint32_t, uint32_t>> found;
  const FrameSearch search{nowhere, [&](const PreparedFrame& frame, const LoggedFrame& neighbor) {
                             found.emplace_back(frame.id.value, neighbor.frame.value);
                             return located_at(7);
                           }};
  FrameLog log;
  for (uint32_t i = 0; i < 6; ++i)
    log.push_back(logged(i, i == 3 ? TrackStatus::kTracked : TrackStatus::kLost));
  log[0].features = nullptr;  // nothing to search with
  log = relocalize_lost_frames(std::move(log), kHeight_px, search);
  EXPECT_EQ(found, (std::vector<std::pair<uint32_t, uint32_t>>{{2, 3}, {1, 2}, {4, 3}, {5, 4}}));
  for (size_t i = 1; i < log.size(); ++i) EXPECT_EQ(log[i].status, TrackStatus::kTracked) << i;
  EXPECT_EQ(log[0].status, TrackStatus::kLost);
}

TEST(RelocalizeLostFrames, KeepsFramesLostThatAreNotFound) {
  const FrameSearch search{
      nowhere, [](const PreparedFrame&, const LoggedFrame&) -> std::optional<TrackResult> { return {}; }};
  const FrameLog log = relocalize_lost_frames(
      {logged(0, TrackStatus::kTracked), logged(1, TrackStatus::kLost)}, kHeight_px, search);
  EXPECT_EQ(log[1].status, TrackStatus::kLost);
  EXPECT_TRUE(log[1].features) << "may be searched again";
}

}  // namespace
}  // namespace kinloop
