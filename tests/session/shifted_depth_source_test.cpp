#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "kinloop/core/time.hpp"
#include "session/source/source_filters.hpp"

namespace kinloop {
namespace {

constexpr int64_t kInterval_ns = 33'000'000;

/// Frames i whose depth, i + 1 metres, has the stamp of colour but was taken `late` frames before.
class LateDepth : public FrameSource {
 public:
  explicit LateDepth(int late, uint32_t frames = 40) : late_(late), frames_(frames) {}

  std::optional<Frame> next() override {
    if (i_ == frames_) return std::nullopt;
    Frame frame;
    frame.id = FrameId{i_};
    frame.stamp_ns = 1'000'000'000 + int64_t{i_} * kInterval_ns;
    frame.color = ColorImage(cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(i_)));
    frame.depth_m = cv::Mat(2, 2, CV_32FC1, cv::Scalar(1 + static_cast<int>(i_) - late_));
    frame.mask = cv::Mat(2, 2, CV_8UC1, cv::Scalar(i_ + 1));
    ++i_;
    return frame;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

 private:
  int late_;
  uint32_t frames_, i_ = 0;
  RgbdCamera camera_;
  SourceInfo info_;
};

TEST(ShiftedDepthSource, PairsColourWithTheDepthOfItsTime) {
  for (const int late : {-35, -3, 2, 35}) {  // more than a second as well
    ShiftedDepthSource source(std::make_unique<LateDepth>(late), -to_seconds(late * kInterval_ns));
    int frames = 0;
    while (const auto frame = source.next()) {
      const int number = frame->color.bgr().at<cv::Vec3b>(0, 0)[0];
      EXPECT_EQ(frame->depth_m.at<float>(0, 0), static_cast<float>(number + 1)) << late;
      EXPECT_EQ(frame->depth_stamp_ns, frame->stamp_ns);
      EXPECT_EQ(frame->mask.at<uint8_t>(0, 0), number + 1);
      EXPECT_EQ(frame->id.value, static_cast<uint32_t>(frames++));
    }
    EXPECT_EQ(frames, 40 - std::abs(late)) << late;
    EXPECT_GE(source.skipped().size(), static_cast<size_t>(std::abs(late))) << late;
  }
}

TEST(ShiftedDepthSource, ARestBelowHalfAnIntervalStaysInTheStamps) {
  ShiftedDepthSource source(std::make_unique<LateDepth>(2), -to_seconds(2 * kInterval_ns) + 0.01);
  const auto frame = source.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame->depth_stamp_ns - frame->stamp_ns, 10'000'000);
}

}  // namespace
}  // namespace kinloop
