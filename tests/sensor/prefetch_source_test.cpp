#include "kinloop/sensor/prefetch_source.hpp"

#include <atomic>
#include <stdexcept>

#include <gmock/gmock.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/sensor/tum_source.hpp"
#include "tests/sensor/sequence_folder.hpp"

namespace kinloop {
namespace {

using test::SequenceFolder;
using testing::IsEmpty;
using testing::SizeIs;

/// Counts to `frames`, skips every third, and throws at `throw_at` where that is not negative.
class CountingSource : public FrameSource {
 public:
  CountingSource(int frames, int throw_at, std::atomic<int>& reads)
      : frames_(frames), throw_at_(throw_at), reads_(reads) {
    info_.frames = static_cast<size_t>(frames);
  }

  std::optional<RgbdFrame> next() override {
    while (at_ < frames_) {
      const int now = at_++;
      ++reads_;
      if (now == throw_at_) throw InputError("frame " + std::to_string(now));
      if (now % 3 == 2) {
        skipped_.push_back({std::to_string(now), "every third"});
        continue;
      }
      RgbdFrame frame;
      frame.stamp_ns = now;
      return frame;
    }
    return std::nullopt;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  int frames_, throw_at_, at_ = 0;
  std::atomic<int>& reads_;
  RgbdCamera camera_;
  SourceInfo info_;
  std::vector<SkippedFrame> skipped_;
};

class Prefetch : public testing::Test {
 protected:
  std::unique_ptr<CountingSource> counting(int frames, int throw_at = -1) {
    return std::make_unique<CountingSource>(frames, throw_at, reads_);
  }

  std::atomic<int> reads_ = 0;
};

TEST_F(Prefetch, GivesWhatTheSourceGivesStepByStep) {
  auto plain = counting(100);
  PrefetchSource ahead(counting(100), 3);
  EXPECT_EQ(ahead.info().frames, 100U);
  while (true) {
    const auto expected = plain->next();
    const auto frame = ahead.next();
    ASSERT_EQ(frame.has_value(), expected.has_value());
    EXPECT_EQ(ahead.skipped().size(), plain->skipped().size());  // not those that are only read ahead
    if (!frame) break;
    EXPECT_EQ(frame->stamp_ns, expected->stamp_ns);
  }
  EXPECT_THAT(ahead.skipped(), SizeIs(33));
  EXPECT_FALSE(ahead.next());
  EXPECT_FALSE(ahead.next());
}

TEST_F(Prefetch, ExceptionComesAtItsPlaceInTheSequence) {
  PrefetchSource ahead(counting(10, 4), 8);
  for (const int stamp : {0, 1, 3}) EXPECT_EQ(ahead.next()->stamp_ns, stamp);
  EXPECT_THROW(ahead.next(), InputError);
  EXPECT_FALSE(ahead.next());
}

TEST_F(Prefetch, ReadsNoFurtherAheadThanAsked) {
  {
    PrefetchSource ahead(counting(1000), 4);
    EXPECT_EQ(ahead.next()->stamp_ns, 0);
  }
  // One taken, four waiting, one in hand, and those of them that were skipped.
  EXPECT_LE(reads_, 9);
}

TEST_F(Prefetch, CanBeDroppedBeforeAndAfterTheEnd) {
  { const PrefetchSource untouched(counting(1000)); }
  { const PrefetchSource empty(counting(0)); }
  PrefetchSource drained(counting(2));
  while (drained.next()) {
  }
  EXPECT_THAT(drained.skipped(), IsEmpty());
}

TEST_F(Prefetch, NoSourceIsABrokenPromise) {
  EXPECT_THROW(PrefetchSource(nullptr), std::logic_error);
}

TEST_F(Prefetch, ReadsASequenceJustAsWell) {
  const SequenceFolder sequence(20);
  sequence.folder.write("rgb/7.png", "spoilt");
  TumSource plain(sequence.path());
  PrefetchSource ahead(std::make_unique<TumSource>(sequence.path()));
  EXPECT_EQ(ahead.camera().color.width, test::kWidth);
  while (const auto expected = plain.next()) {
    const auto frame = ahead.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->id, expected->id);
    EXPECT_EQ(frame->stamp_ns, expected->stamp_ns);
    EXPECT_EQ(cv::norm(frame->color, expected->color, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frame->depth_m, expected->depth_m, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(ahead.next());
  EXPECT_THAT(ahead.skipped(), SizeIs(1));
}

}  // namespace
}  // namespace kinloop
