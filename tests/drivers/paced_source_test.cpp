#include "drivers/live/paced_source.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace kinloop {
namespace {

/// Frames with stamps 0, 1, 2, ...
class NumberedSource : public FrameSource {
 public:
  explicit NumberedSource(int64_t frames) { info_.frames = static_cast<size_t>(frames); }

  std::optional<Frame> next() override {
    if (at_ >= static_cast<int64_t>(info_.frames)) return std::nullopt;
    Frame frame;
    frame.stamp_ns = at_++;
    return frame;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

 private:
  RgbdCamera camera_;
  SourceInfo info_;
  int64_t at_ = 0;
};

/// A consumer that takes `work_s` per frame, on a simulated clock.
struct Replay {
  std::vector<int64_t> taken;
  std::vector<double> taken_at_s;
  size_t dropped = 0;
};

Replay replay(double rate_hz, const std::function<double(int64_t)>& work_s, int64_t frames = 90) {
  double now_s = 100;
  const PaceClock clock{[&] { return now_s; }, [&](double until_s) { now_s = std::max(now_s, until_s); }};
  PacedSource source(std::make_unique<NumberedSource>(frames), rate_hz, clock);
  Replay result;
  while (const auto frame = source.next()) {
    result.taken.push_back(frame->stamp_ns);
    result.taken_at_s.push_back(now_s - 100);
    now_s += work_s(frame->stamp_ns);
  }
  result.dropped = source.dropped();
  return result;
}

TEST(PacedSource, AFastConsumerGetsEveryFrameOnTime) {
  const Replay result = replay(30, [](int64_t) { return 0.02; });
  ASSERT_EQ(result.taken.size(), 90U);
  EXPECT_EQ(result.dropped, 0U);
  for (size_t i = 0; i < result.taken.size(); ++i) {
    EXPECT_NEAR(result.taken_at_s[i], static_cast<double>(i) / 30, 1e-9);
  }
}

TEST(PacedSource, TheBufferAbsorbsOneSlowFrame) {
  const Replay result = replay(30, [](int64_t n) { return n == 40 ? 0.12 : 0.02; });
  EXPECT_EQ(result.dropped, 0U);
  EXPECT_EQ(result.taken.size(), 90U);
}

TEST(PacedSource, ASlowConsumerLosesFramesAndStaysCurrent) {
  const Replay result = replay(30, [](int64_t) { return 0.1; });
  EXPECT_EQ(result.taken.size() + result.dropped, 90U);
  EXPECT_NEAR(static_cast<double>(result.taken.size()), 30, 4);  // 0.1 s per frame leaves a third
  for (size_t i = 0; i < result.taken.size(); ++i) {
    const double age = result.taken_at_s[i] * 30 - static_cast<double>(result.taken[i]);
    EXPECT_GE(age, -1e-9);
    EXPECT_LE(age, static_cast<double>(PacedSource::kBuffered));
  }
}

TEST(PacedSource, SaysThatItIsLive) {
  const PacedSource source(std::make_unique<NumberedSource>(3), 30);
  EXPECT_TRUE(source.info().live);
  EXPECT_EQ(source.info().frames, 3U);
}

}  // namespace
}  // namespace kinloop
