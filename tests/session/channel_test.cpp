#include <atomic>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "session/source/frame_pipeline.hpp"

namespace kinloop {
namespace {

TEST(Channel, ValuesComeOutInOrder) {
  Channel<int> channel(3);
  for (const int i : {1, 2, 3}) EXPECT_TRUE(channel.push(i));
  for (const int i : {1, 2, 3}) EXPECT_EQ(channel.pop(), i);
}

TEST(Channel, AllValuesPassBetweenTwoThreads) {
  constexpr int kCount = 20000;
  Channel<std::unique_ptr<int>> channel(4);
  std::jthread producer([&] {
    for (int i = 0; i < kCount; ++i) channel.push(std::make_unique<int>(i));
    channel.close();
  });
  int expected = 0;
  while (const auto value = channel.pop()) ASSERT_EQ(**value, expected++);
  EXPECT_EQ(expected, kCount);
}

TEST(Channel, NeverHoldsMoreThanItsCapacity) {
  Channel<int> channel(2);
  std::atomic<int> pushed = 0;
  std::jthread producer([&] {
    for (int i = 0; i < 100; ++i) {
      channel.push(i);
      ++pushed;
    }
  });
  for (int taken = 0; taken < 100; ++taken) {
    EXPECT_LE(pushed, taken + 2);
    EXPECT_EQ(channel.pop(), taken);
  }
}

TEST(Channel, ClosedChannelIsDrainedAndTakesNothingMore) {
  Channel<int> channel(2);
  channel.push(1);
  channel.close();
  EXPECT_FALSE(channel.push(2));
  EXPECT_EQ(channel.pop(), 1);
  EXPECT_EQ(channel.pop(), std::nullopt);
  EXPECT_EQ(channel.pop(), std::nullopt);
}

TEST(Channel, ClosingWakesAConsumerThatWaits) {
  Channel<int> channel(1);
  std::jthread consumer([&] { EXPECT_EQ(channel.pop(), std::nullopt); });
  channel.close();
}

TEST(Channel, ClosingWakesAProducerThatWaits) {
  Channel<int> channel(1);
  channel.push(1);
  std::jthread producer([&] { EXPECT_FALSE(channel.push(2)); });
  channel.close();
}

}  // namespace
}  // namespace kinloop
