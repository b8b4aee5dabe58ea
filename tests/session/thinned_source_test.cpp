#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "kinloop/sensor/source/passable_source.hpp"
#include "session/source/source_filters.hpp"

namespace kinloop {
namespace {

/// Frames with the stamps 0, 1, 2, ... ns.
class Numbered : public FrameSource {
 public:
  explicit Numbered(uint32_t frames) { info_.frames = frames; }

  std::optional<Frame> next() override {
    if (i_ == info_.frames) return std::nullopt;
    Frame frame;
    frame.id = FrameId{i_};
    frame.stamp_ns = i_++;
    return frame;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

 private:
  uint32_t i_ = 0;
  RgbdCamera camera_;
  SourceInfo info_;
};

/// The same, and it can pass over frames.
class NumberedPassable : public Numbered, public PassableSource {
 public:
  NumberedPassable(uint32_t frames, int& read) : Numbered(frames), read_(read) {}

  std::optional<Frame> next() override {
    ++read_;
    return Numbered::next();
  }
  bool pass_over() override { return Numbered::next().has_value(); }

 private:
  int& read_;
};

ThinnedSource thinned(uint32_t frames, int step) {
  return {std::make_unique<Numbered>(frames), step};
}

std::vector<int64_t> stamps_ns(ThinnedSource source) {
  std::vector<int64_t> stamps_ns;
  while (const auto frame = source.next()) {
    EXPECT_EQ(frame->id, FrameId{static_cast<uint32_t>(stamps_ns.size())});
    stamps_ns.push_back(frame->stamp_ns);
  }
  EXPECT_EQ(stamps_ns.size(), source.info().frames);
  return stamps_ns;
}

using Stamps = std::vector<int64_t>;

TEST(ThinnedSource, GivesTheFirstAndEveryNthFrameWithConsecutiveIds) {
  EXPECT_EQ(stamps_ns(thinned(8, 1)), (Stamps{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(stamps_ns(thinned(8, 3)), (Stamps{0, 3, 6}));
  EXPECT_EQ(stamps_ns(thinned(9, 3)), (Stamps{0, 3, 6}));
  EXPECT_EQ(stamps_ns(thinned(8, 7)), (Stamps{0, 7}));
  EXPECT_EQ(stamps_ns(thinned(8, 100)), Stamps{0});
  EXPECT_EQ(stamps_ns(thinned(0, 3)), Stamps{});
}

TEST(ThinnedSource, DoesNotReadFramesThatCanBePassedOver) {
  int read = 0;
  EXPECT_EQ(stamps_ns({std::make_unique<NumberedPassable>(8, read), 3}), (Stamps{0, 3, 6}));
  EXPECT_EQ(read, 3);
}

TEST(ThinnedSource, HasTheRateThatIsLeft) {
  EXPECT_DOUBLE_EQ(thinned(8, 3).camera().fps, Numbered(8).camera().fps / 3);
}

TEST(ThinnedSource, RefusesAStepOutOfRange) {
  for (const int step : {0, -3, ThinnedSource::kMaxStep + 1})
    EXPECT_THROW(thinned(8, step), std::logic_error);
}

}  // namespace
}  // namespace kinloop
