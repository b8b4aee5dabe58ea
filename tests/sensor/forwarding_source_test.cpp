#include "kinloop/sensor/source/forwarding_source.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

/// One frame, then the end, which it counts as skipped.
class OneFrameSource : public FrameSource {
 public:
  OneFrameSource() {
    camera_.depth_scale = 1234;
    info_.name = "one";
  }

  std::optional<Frame> next() override {
    if (!std::exchange(taken_, true)) return Frame();
    skipped_.add({"end", "none is left"});
    return std::nullopt;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return skipped_; }

 private:
  RgbdCamera camera_;
  SourceInfo info_;
  SkippedFrames skipped_;
  bool taken_ = false;
};

class LaterSource : public ForwardingSource {
 public:
  explicit LaterSource(std::unique_ptr<FrameSource> source) : ForwardingSource(std::move(source)) {}

  std::optional<Frame> next() override {
    auto frame = source().next();
    if (frame) ++frame->stamp_ns;
    return frame;
  }
};

TEST(ForwardingSource, IsTheOtherSourceButForItsFrames) {
  LaterSource later(std::make_unique<OneFrameSource>());
  EXPECT_EQ(later.camera().depth_scale, 1234);
  EXPECT_EQ(later.info().name, "one");
  EXPECT_TRUE(later.skipped().empty());
  EXPECT_EQ(later.next()->stamp_ns, 1);
  EXPECT_FALSE(later.next());
  EXPECT_EQ(later.skipped().front().name, "end");
}

TEST(ForwardingSource, NeedsASource) {
  EXPECT_THROW(LaterSource(nullptr), std::logic_error);
}

}  // namespace
}  // namespace kinloop
