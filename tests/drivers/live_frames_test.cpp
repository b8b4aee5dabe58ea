#include "drivers/live/live_frames.hpp"

#include <algorithm>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using std::chrono::milliseconds;

cv::Mat color() {
  return {2, 2, CV_8UC3, cv::Scalar::all(1)};
}

cv::Mat depth() {
  return {2, 2, CV_32FC1, cv::Scalar(1)};
}

TEST(LiveFrameBuffer, GivesFramesInOrderAndLosesTheOldest) {
  LiveFrameBuffer frames;
  EXPECT_FALSE(frames.wait(milliseconds(1)));
  for (int64_t i = 1; i <= 10; ++i) {
    frames.add_color(i * 33'000'000, color());
    frames.add_depth(i * 33'000'000, depth());
  }
  EXPECT_EQ(frames.counts().dropped, 10 - LiveFrameBuffer::kBuffered);
  int64_t expected = 10 - static_cast<int64_t>(LiveFrameBuffer::kBuffered);
  while (const auto frame = frames.wait(milliseconds(1))) EXPECT_EQ(frame->stamp_ns, ++expected * 33'000'000);
  EXPECT_EQ(expected, 10);
}

TEST(LiveFrameBuffer, StampsContinueWhenTheClockIsSetBack) {
  LiveFrameBuffer frames;
  constexpr int64_t kMilliNs = 1'000'000, kHourNs = 3600 * 1000 * kMilliNs;
  std::vector<int64_t> given_ms;
  // An hour back, then two hours on by mistake for one image, which ends in another step back.
  for (const int64_t stamp_ns : {kHourNs, kHourNs + 33 * kMilliNs, 40 * kMilliNs, 73 * kMilliNs, 2 * kHourNs,
                                 106 * kMilliNs, 139 * kMilliNs}) {
    frames.add_color(stamp_ns, color());
    frames.add_depth(stamp_ns + kMilliNs, depth());
    frames.add_color(stamp_ns + 5 * kMilliNs, color());  // without depth: the frame before is settled
    if (const auto frame = frames.wait(milliseconds(1))) {
      EXPECT_EQ(frame->depth_stamp_or_color_ns() - frame->stamp_ns, kMilliNs);
      given_ms.push_back((frame->stamp_ns - kHourNs) / kMilliNs);
    }
  }
  EXPECT_THAT(given_ms,
              testing::ElementsAre(0, 33, 138, 171, testing::Gt(3'600'000), testing::_, testing::_));
  EXPECT_TRUE(std::is_sorted(given_ms.begin(), given_ms.end()));
  EXPECT_EQ(frames.counts().out_of_order, 0U);
}

TEST(LiveFrameBuffer, WaitsForAnotherThread) {
  LiveFrameBuffer frames;
  const std::jthread driver([&] {
    frames.add_depth(5, depth());
    frames.add_color(5, color());
  });
  EXPECT_TRUE(frames.wait(milliseconds(10'000)));
}

TEST(LiveFrameBuffer, TheLastFrameWaitsForANearerPartnerUntilTheEnd) {
  LiveFrameBuffer frames;
  frames.add_color(100'000'000, color());
  frames.add_depth(108'000'000, depth());
  EXPECT_FALSE(frames.wait(milliseconds(1)));
  frames.finish();
  const auto last = frames.wait(milliseconds(0));
  ASSERT_TRUE(last);
  EXPECT_EQ(last->depth_stamp_ns, 108'000'000);
}

TEST(LiveFrameBuffer, StampsAtTheEndsOfTimeDoNotOverflow) {
  LiveFrameBuffer frames;
  for (int i = 0; i < 4; ++i) {
    for (const int64_t stamp_ns :
         {std::numeric_limits<int64_t>::max(), std::numeric_limits<int64_t>::min()}) {
      frames.add_color(stamp_ns, color());
      frames.add_depth(stamp_ns, depth());
      frames.add_pair(stamp_ns, color(), ~stamp_ns, depth());
    }
  }
  frames.finish();
  while (const auto frame = frames.wait(milliseconds(0))) EXPECT_LE(frame->stamp_ns, kMaxStampNs);
  EXPECT_GT(frames.counts().out_of_order, 0U);
}

TEST(SkippedFrames, AreAllCountedAndTheFirstKept) {
  SkippedFrames skipped = to_skipped_frames({size_t{1} << 40, 3, 0});
  skipped.add({"image", "damaged"});
  EXPECT_EQ(skipped.size(), (size_t{1} << 40) + 4);
  EXPECT_EQ(std::distance(skipped.begin(), skipped.end()), SkippedFrames::kKept);
  EXPECT_EQ(skipped.front().name, "frame");
  SkippedFrames all;
  all.add({"first", "of another list"});
  all.add(skipped);
  EXPECT_EQ(all.size(), skipped.size() + 1);
  EXPECT_EQ(all.front().name, "first");
  all.clear();
  EXPECT_TRUE(all.empty());
}

TEST(LiveFrameBuffer, SaysWhatWasLost) {
  LiveFrameBuffer frames;
  frames.add_color(100, color());
  frames.add_color(50, color());
  const auto skipped = to_skipped_frames(frames.counts());
  ASSERT_EQ(skipped.size(), 1U);
  EXPECT_THAT(skipped.front().reason, testing::HasSubstr("does not increase"));
}

}  // namespace
}  // namespace kinloop
