#include "session/thinned_source.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "session/open_frame_source.hpp"

namespace kinloop {
namespace {

SourceRequest small_room(int every) {
  SourceRequest request;
  request.sequence = "sim:room";
  request.simulation.frames = 8;
  request.simulation.width = 64;
  request.simulation.height = 48;
  request.every = every;
  return request;
}

std::vector<int64_t> stamps_ns(FrameSource& source) {
  std::vector<int64_t> stamps_ns;
  while (const auto frame = source.next()) {
    EXPECT_EQ(frame->id, FrameId{static_cast<uint32_t>(stamps_ns.size())});
    stamps_ns.push_back(frame->stamp_ns);
  }
  return stamps_ns;
}

TEST(ThinnedSource, GivesTheFirstAndEveryNthFrameWithConsecutiveIds) {
  const auto all = stamps_ns(*open_frame_source(small_room(1)));
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(stamps_ns(*open_frame_source(small_room(3))), (std::vector{all[0], all[3], all[6]}));
  EXPECT_EQ(stamps_ns(*open_frame_source(small_room(7))), (std::vector{all[0], all[7]}));
  EXPECT_EQ(stamps_ns(*open_frame_source(small_room(100))), std::vector{all[0]});
}

TEST(ThinnedSource, TellsItsOwnRateAndNumberOfFrames) {
  const auto all = open_frame_source(small_room(1)), thinned = open_frame_source(small_room(3));
  EXPECT_DOUBLE_EQ(thinned->camera().fps, all->camera().fps / 3);
  EXPECT_EQ(thinned->info().frames, 3u);
  EXPECT_EQ(thinned->info().ground_truth.size(), all->info().ground_truth.size());
}

TEST(ThinnedSource, RefusesAStepOutOfRange) {
  for (const int step : {0, -3, ThinnedSource::kMaxStep + 1})
    EXPECT_THROW(ThinnedSource(open_frame_source(small_room(1)), step), std::logic_error);
}

}  // namespace
}  // namespace kinloop
