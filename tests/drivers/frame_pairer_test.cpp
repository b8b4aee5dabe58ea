#include "drivers/live/frame_pairer.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

constexpr int64_t kMs = 1'000'000;

/// A depth image that encodes its number; colour images encode theirs in their width.
cv::Mat numbered(int64_t number) {
  return {1, 1, CV_32SC1, cv::Scalar(static_cast<double>(number))};
}

struct Pair {
  int64_t color_ms, depth_ms;
  bool operator==(const Pair&) const = default;
};

std::vector<Pair> taken(FramePairer& pairer) {
  std::vector<Pair> pairs;
  while (const auto frame = pairer.next()) {
    const int64_t color_ms = frame->color.bgr().cols - 1;
    EXPECT_EQ(frame->stamp_ns, color_ms * kMs);
    EXPECT_EQ(frame->depth_stamp_ns, frame->depth_m.at<int>(0) * kMs);
    pairs.push_back({color_ms, frame->depth_m.at<int>(0)});
  }
  return pairs;
}

void add_color(FramePairer& pairer, int64_t ms) {
  pairer.add_color(ms * kMs, cv::Mat(1, static_cast<int>(ms) + 1, CV_8UC3));
}
void add_depth(FramePairer& pairer, int64_t ms) {
  pairer.add_depth(ms * kMs, numbered(ms));
}

TEST(FramePairer, PairsEqualStampsAtOnce) {
  FramePairer pairer;
  for (const int64_t ms : {100, 133, 166}) {
    add_color(pairer, ms);
    EXPECT_TRUE(taken(pairer).empty());
    add_depth(pairer, ms);
    EXPECT_THAT(taken(pairer), testing::ElementsAre(Pair{ms, ms}));
  }
  EXPECT_EQ(pairer.unpaired(), 0U);
}

TEST(FramePairer, TakesTheNearestInTimeInWhateverOrderTheyCome) {
  // Depth 15 ms after its colour image, 18 ms before the next.
  std::vector<Pair> truth;
  for (int64_t i = 0; i < 40; ++i) truth.push_back({33 * i + 100, 33 * i + 115});
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    FramePairer pairer;
    size_t colors = 0, depths = 0;
    std::vector<Pair> found;
    while (colors < truth.size() || depths < truth.size()) {
      const bool color = depths == truth.size() || (colors < truth.size() && random.uniform() < 0.5);
      if (color) {
        add_color(pairer, truth[colors++].color_ms);
      } else {
        add_depth(pairer, truth[depths++].depth_ms);
      }
      for (const Pair& pair : taken(pairer)) found.push_back(pair);
    }
    pairer.finish();
    for (const Pair& pair : taken(pairer)) found.push_back(pair);
    EXPECT_EQ(found, truth) << seed;
  }
}

TEST(FramePairer, LeavesOutImagesWithoutPartner) {
  FramePairer pairer;
  for (const int64_t ms : {100, 133, 166, 200}) add_color(pairer, ms);
  for (const int64_t ms : {101, 167, 300}) add_depth(pairer, ms);
  pairer.finish();
  EXPECT_THAT(taken(pairer), testing::ElementsAre(Pair{100, 101}, Pair{166, 167}));
  EXPECT_EQ(pairer.unpaired(), 2U);
}

TEST(FramePairer, KeepsTogetherWhatWasAddedTogether) {
  FramePairer pairer;
  for (const int64_t ms : {100, 133, 166}) {
    // Nearer to other colour images, and further away than any pair found by time.
    pairer.add_pair(ms * kMs, cv::Mat(1, static_cast<int>(ms) + 1, CV_8UC3), (ms + 30) * kMs,
                    numbered(ms + 30));
    EXPECT_THAT(taken(pairer), testing::ElementsAre(Pair{ms, ms + 30}));
  }
  EXPECT_EQ(pairer.unpaired() + pairer.out_of_order(), 0U);
}

TEST(FramePairer, CountsTimeGoingBackwards) {
  FramePairer pairer;
  for (const int64_t ms : {100, 133, 90, 133, 166}) {
    add_color(pairer, ms);
    add_depth(pairer, ms);
  }
  EXPECT_EQ(taken(pairer).size(), 3U);
  EXPECT_EQ(pairer.out_of_order(), 4U);
}

TEST(FramePairer, DoesNotKeepImagesOfOneCameraForEver) {
  FramePairer pairer;
  for (int64_t i = 0; i < 1000; ++i) add_color(pairer, 33 * i);
  EXPECT_TRUE(taken(pairer).empty());
  EXPECT_GT(pairer.unpaired(), 900U);
}

}  // namespace
}  // namespace kinloop
