#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "session/input/checks/checks.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int64_t kInterval_ns = kNsPerSecond / 30;

/// Frames of noise at 30 Hz. From frame `from` to `to`, colour or depth is that of `from`.
struct Stream {
  int color_from = -1, color_to = -1, depth_from = -1, depth_to = -1;

  [[nodiscard]] Frame frame(int i) const {
    const auto image = [](int seed, int type, double low, double high) {
      cv::Mat made(48, 64, type);
      cv::RNG random(static_cast<uint64_t>(seed) + 1);
      random.fill(made, cv::RNG::UNIFORM, low, high);
      return made;
    };
    Frame made;
    made.stamp_ns = 7 * kNsPerSecond + i * kInterval_ns;
    made.gray = image(i >= color_from && i < color_to ? color_from : i, CV_8UC1, 0, 256);
    made.depth_m = image(i >= depth_from && i < depth_to ? depth_from : i, CV_32FC1, 1, 3);
    return made;
  }
};

FrozenCheck frozen_check_of(const Stream& stream) {
  FrozenCheck check;
  for (int i = 0; i < 90; ++i) check.observe(stream.frame(i));
  return check;
}

TEST(FrozenCheck, SaysNothingOfStreamsThatGoOn) {
  const FrozenCheck check = frozen_check_of({});
  EXPECT_FALSE(check.depth());
  EXPECT_FALSE(check.color());
}

TEST(FrozenCheck, SaysNothingOfAPauseOfBothOrAShortOne) {
  for (const Stream& stream : {Stream{30, 60, 30, 60}, Stream{-1, -1, 30, 42}}) {
    const FrozenCheck check = frozen_check_of(stream);
    EXPECT_FALSE(check.depth());
    EXPECT_FALSE(check.color());
  }
}

TEST(FrozenCheck, NamesTheStreamAndTheTime) {
  const auto depth = frozen_check_of({-1, -1, 30, 60}).depth();
  ASSERT_TRUE(depth);
  EXPECT_THAT(depth->evidence, AllOf(HasSubstr("depth froze once while colour went on, for 1.0 s"),
                                     HasSubstr("1.0 s to 2.0 s")));
  const auto color = frozen_check_of({60, 90, -1, -1}).color();
  ASSERT_TRUE(color);
  EXPECT_THAT(color->evidence, HasSubstr("colour froze once while depth went on, for 1.0 s"));
}

}  // namespace
}  // namespace kinloop
