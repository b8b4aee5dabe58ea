#include "kinloop/tracking/evidence/depth_continuity.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "tests/support/pinhole_cameras.hpp"

namespace kinloop {
namespace {

/// A camera in front of a wall with bumps.
class DepthOfAStream : public testing::Test {
 protected:
  static constexpr int kWidth = 320, kHeight = 240;

  /// The wall from `distance_m`, its depth multiplied by `scale`.
  [[nodiscard]] cv::Mat depth_from(double distance_m, double scale = 1) {
    cv::Mat depth_m(kHeight, kWidth, CV_32FC1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double z = distance_m + 0.2 * std::sin(x / 30.0) + 0.2 * std::cos(y / 40.0);
        depth_m.at<float>(y, x) = static_cast<float>(scale * (z + 0.004 * random_.gaussian()));
      }
    }
    return depth_m;
  }

  /// Shows the next frame; returns the factor for its depth. The image is new unless told otherwise.
  double observe(const cv::Mat& depth_m, std::optional<Velocity> velocity = Velocity{},
                 bool new_image = true) {
    if (new_image || bgr_.empty())
      bgr_ = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(100 + count_ % 7));
    Frame frame;
    frame.id = FrameId{count_};
    frame.stamp_ns = count_++ * kNsPerSecond / 30;
    frame.color = bgr_;
    frame.depth_m = depth_m.clone();
    continuity_.observe(front_end_.prepare(frame), velocity);
    return continuity_.factor();
  }

  FrontEnd front_end_{test::sensor_of(test::qvga_camera()), {}};
  DepthContinuity continuity_;
  Random random_{1};
  uint32_t count_ = 0;
  cv::Mat bgr_;
};

TEST_F(DepthOfAStream, AChangeOfScaleIsMeasured) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(observe(depth_from(2)), 1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(observe(depth_from(2, 0.9)), 1 / 0.9, 0.003);
}

TEST_F(DepthOfAStream, AScaleThatReturnsIsExactlyTheFirstOne) {
  observe(depth_from(2));
  observe(depth_from(2, 1.1));
  EXPECT_EQ(observe(depth_from(2)), 1);
}

TEST_F(DepthOfAStream, AChangeOfScaleAfterARepeatedFrameIsMeasured) {
  const cv::Mat depth_m = depth_from(2);
  observe(depth_m);
  observe(depth_m, Velocity{}, false);
  EXPECT_NEAR(observe(depth_from(2, 0.9)), 1 / 0.9, 0.003);
}

TEST_F(DepthOfAStream, AMotionTowardsTheWallIsNoChangeOfScale) {
  Velocity forward;
  forward.linear_m_s = {0, 0, 1.5};
  for (int i = 0; i < 10; ++i) EXPECT_EQ(observe(depth_from(2 - 0.05 * i), forward), 1) << i;
}

TEST_F(DepthOfAStream, TheVelocityOverAGapIsNotThatOfTheNextFrame) {
  observe(depth_from(2));
  count_ += 30;
  observe(depth_from(2));
  EXPECT_EQ(observe(depth_from(1.94)), 1);
}

TEST_F(DepthOfAStream, WithoutAVelocityTheScaleIsNotChecked) {
  observe(depth_from(2));
  EXPECT_EQ(observe(depth_from(2, 0.9), std::nullopt), 1);
}

TEST_F(DepthOfAStream, SomethingNearIsNoChangeOfScale) {
  observe(depth_from(2));
  cv::Mat depth_m = depth_from(2);
  depth_m(cv::Rect(0, 0, kWidth * 3 / 4, kHeight)) = 0.8F;
  EXPECT_EQ(observe(depth_m), 1);
}

TEST_F(DepthOfAStream, AfterACutTheScaleIsNotChecked) {
  observe(depth_from(2));
  bgr_ = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(180));
  EXPECT_EQ(observe(depth_from(2, 0.9), Velocity{}, false), 1);
}

TEST_F(DepthOfAStream, FrozenDepthIsNotUsed) {
  const cv::Mat frozen = depth_from(2);
  double factor = 1;
  for (int i = 0; i < 5; ++i) factor = observe(frozen);
  EXPECT_EQ(factor, 1);  // a slower depth stream
  for (int i = 0; i < 5; ++i) factor = observe(frozen);
  EXPECT_EQ(factor, 0);
  EXPECT_NEAR(continuity_.age_s(), 0.3, 1e-6);
  EXPECT_EQ(continuity_.new_depth_ns(), 0);
  EXPECT_EQ(observe(depth_from(2)), 1);
  EXPECT_EQ(continuity_.age_s(), 0);
}

TEST_F(DepthOfAStream, TheJumpAfterAFreezeIsNoChangeOfScale) {
  const cv::Mat frozen = depth_from(2);
  for (int i = 0; i < 10; ++i) observe(frozen);
  EXPECT_EQ(observe(depth_from(1.7)), 1);
}

TEST_F(DepthOfAStream, MissingDepthIsLikeFrozenDepth) {
  observe(depth_from(2));
  double factor = 1;
  for (int i = 0; i < 8; ++i) factor = observe(cv::Mat::zeros(kHeight, kWidth, CV_32FC1));
  EXPECT_EQ(factor, 0);
}

TEST_F(DepthOfAStream, WhereTheImageIsRepeatedTooNothingIsFrozen) {
  const cv::Mat depth_m = depth_from(2);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(observe(depth_m, Velocity{}, false), 1);
}

}  // namespace
}  // namespace kinloop
