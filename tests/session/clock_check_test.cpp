#include <deque>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "kinloop/core/time.hpp"
#include "session/input/checks/checks.hpp"
#include "session/source/open_frame_source.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// What is said of frames at an interval, of a camera of 30 Hz.
std::string stamps_text(double interval_s) {
  ClockCheck check(30);
  for (int i = 0; i < 20; ++i) {
    Frame frame;
    frame.stamp_ns = static_cast<int64_t>(1e9 * interval_s * i);
    frame.gray = cv::Mat::zeros(48, 64, CV_8UC1);
    frame.depth_m = cv::Mat::ones(48, 64, CV_32FC1);
    check.observe(frame);
  }
  const auto warning = check.stamps();
  return warning ? text_of(*warning) : "";
}

TEST(ClockCheck, SaysNothingOfUsualRates) {
  for (const double rate_hz : {5, 10, 15, 30, 60, 90}) EXPECT_EQ(stamps_text(1 / rate_hz), "");
}

TEST(ClockCheck, NamesTheUnitOfStamps) {
  EXPECT_THAT(stamps_text(33.3),
              AllOf(HasSubstr("0.03 frames per second"), HasSubstr("as if milliseconds are read as seconds"),
                    HasSubstr("multiply all stamps by 0.001")));
  EXPECT_THAT(stamps_text(33.3e-6), HasSubstr("seconds are read as milliseconds"));
}

TEST(ClockCheck, NamesARateFarFromThatOfTheCamera) {
  EXPECT_THAT(stamps_text(1),
              AllOf(HasSubstr("1 frames per second where the camera has 30"), HasSubstr("correct fps")));
}

TEST(MotionLag, IsTheShiftBetweenTwoSignalsEvenIfTheyAreShort) {
  for (const size_t frames : {400U, 120U}) {
    constexpr int kLag = 25;
    std::mt19937 random(1);
    std::lognormal_distribution<float> speed(0, 1);
    std::vector<float> color(frames), depth(frames);
    for (float& value : color) value = speed(random);
    for (size_t i = kLag; i < depth.size(); ++i) depth[i] = 0.1F * color[i - kLag] + 0.02F * speed(random);
    const auto lag = motion_lag(color, depth, 100);
    ASSERT_TRUE(lag);
    EXPECT_EQ(lag->frames, kLag);
    EXPECT_GT(lag->correlation, 0.7);
    EXPECT_LT(lag->without_lag, 0.3);
    EXPECT_GT(lag->score, 2 * lag->elsewhere);
  }
}

TEST(MotionLag, NeedsTwoSecondsOfBothSignals) {
  EXPECT_FALSE(motion_lag(std::vector<float>(62, 1), std::vector<float>(62, 1), 100));
  EXPECT_FALSE(motion_lag({}, {}, 100));
  EXPECT_THROW(motion_lag(std::vector<float>(200, 1), std::vector<float>(100, 1), 50), std::logic_error);
}

/// What is said of a real recording whose depth comes `late` frames later.
std::string depth_clock_text(const std::filesystem::path& sequence, size_t late, int frames) {
  SourceRequest request;
  request.sequence = sequence.string();
  const auto source = open_frame_source(request);
  ClockCheck check(30);
  std::deque<cv::Mat> depths;
  for (int i = 0; i < frames; ++i) {
    auto frame = source->next();
    if (!frame) break;
    depths.push_back(frame->depth_m);
    if (depths.size() <= late) continue;  // the first images have no partner
    frame->depth_m = depths.front();
    depths.pop_front();
    check.observe(*frame);
  }
  const auto warning = check.depth_clock();
  return warning ? text_of(*warning) : "";
}

TEST(ClockCheck, MeasuresHowLateDepthIs) {
  const auto sequence = test::shared_data("redkitchen");
  KINLOOP_SKIP_WITHOUT(sequence);
  EXPECT_EQ(depth_clock_text(sequence, 0, 420), "");
  EXPECT_THAT(depth_clock_text(sequence, 30, 240),
              AllOf(HasSubstr("1.00 s later"), HasSubstr("add -1.00 s to the stamps of depth")));
  EXPECT_THAT(depth_clock_text(sequence, 96, 420), HasSubstr("--depth-offset -3."));
}

}  // namespace
}  // namespace kinloop
