#include "drivers/live/reconnection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

/// A camera that sends, each time it is opened, the number of frames in `plan`; negative: no camera.
class FakeCamera {
 public:
  explicit FakeCamera(std::vector<int> plan) : plan_(std::move(plan)) { open(); }

  std::optional<Frame> next(double max_wait_s = 10, const StopRequest& stop = {}) {
    return next_or_reconnect(frames_, {"fake", milliseconds(5), max_wait_s,
                                       [this] {
                                         if (open_) calls_.emplace_back("close");
                                         open_ = false;
                                       },
                                       [this] { open(); }, stop});
  }
  [[nodiscard]] const std::vector<std::string>& calls() const { return calls_; }

 private:
  void open() {
    const int count = opened_ < plan_.size() ? plan_[opened_++] : -1;
    calls_.emplace_back(count < 0 ? "absent" : "open");
    if (count < 0) throw InputError("not there");
    open_ = true;
    for (int i = 0; i < count; ++i) {
      stamp_ns_ += 33'000'000;
      frames_.add_color(stamp_ns_, cv::Mat(1, 1, CV_8UC3, cv::Scalar(0)));
      frames_.add_depth(stamp_ns_, {1, 1, CV_32FC1, cv::Scalar(1)});
    }
  }

  std::vector<int> plan_;
  size_t opened_ = 0;
  bool open_ = false;
  int64_t stamp_ns_ = 0;
  std::vector<std::string> calls_;
  LiveFrameBuffer frames_;
};

TEST(Reconnection, LeavesAWorkingCameraOpen) {
  FakeCamera camera({3});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(camera.next());
  EXPECT_THAT(camera.calls(), ElementsAre("open"));
}

TEST(Reconnection, OpensTheCameraAgainAndGoesOn) {
  FakeCamera camera({1, -1, -1, 1});
  const auto first = camera.next(), second = camera.next();
  ASSERT_TRUE(first && second);
  EXPECT_GT(second->stamp_ns, first->stamp_ns);
  EXPECT_EQ(second->id.value, first->id.value + 1);
  EXPECT_THAT(camera.calls(), ElementsAre("open", "close", "absent", "absent", "open"));
}

TEST(Reconnection, OpensACameraAnewThatComesBackWithoutFrames) {
  FakeCamera camera({0, 0, 1});
  EXPECT_TRUE(camera.next());
  EXPECT_THAT(camera.calls(), ElementsAre("open", "close", "open", "close", "open"));
}

TEST(Reconnection, StopsWhenAsked) {
  FakeCamera camera({0});
  const auto begin = std::chrono::steady_clock::now();
  int asked = 0;
  EXPECT_FALSE(camera.next(100, [&] { return ++asked > 2; }));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(50));
}

TEST(Reconnection, GivesUpInTheEnd) {
  FakeCamera camera({0});
  EXPECT_FALSE(camera.next(0.05));
  EXPECT_THAT(camera.calls(), testing::Contains("absent"));
  FakeCamera impatient({0});
  EXPECT_FALSE(impatient.next(0));
  EXPECT_THAT(impatient.calls(), ElementsAre("open")) << "no time to wait: not reopened";
}

}  // namespace
}  // namespace kinloop
