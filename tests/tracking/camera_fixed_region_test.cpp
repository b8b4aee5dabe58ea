#include "kinloop/tracking/evidence/camera_fixed_region.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "tests/support/pinhole_cameras.hpp"

namespace kinloop {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// A room of coloured slopes that shifts in the image, with things in front of it.
class CameraFixed : public testing::Test {
 protected:
  /// The room as seen after it has shifted by `shift_px`, with new noise.
  void look(double shift_px) {
    color_.create(kHeight, kWidth, CV_8UC1);
    depth_m_.create(kHeight, kWidth, CV_32FC1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double u = x + shift_px;
        color_.at<uint8_t>(y, x) =
            static_cast<uint8_t>(120 + 60 * std::sin(u / 9) * std::cos(y / 11.0) + 3 * random_.gaussian());
        depth_m_.at<float>(y, x) =
            static_cast<float>(2.5 + 0.6 * std::sin(u / 25 + y / 40.0) + 0.005 * random_.gaussian());
      }
    }
  }

  /// Paints a thing with stripes, or without any structure.
  void paint(const cv::Rect& area, float depth_m, bool striped = true) {
    for (int y = area.y; y < area.br().y; ++y) {
      for (int x = area.x; x < area.br().x; ++x) {
        const int gray = striped && (x - area.x) / 16 % 2 == 0 ? 170 : 90;
        color_.at<uint8_t>(y, x) = static_cast<uint8_t>(gray + 3 * random_.gaussian());
        depth_m_.at<float>(y, x) = depth_m + static_cast<float>(0.001 * random_.gaussian());
      }
    }
  }

  bool observe() {
    Frame frame;
    frame.id = FrameId{count_};
    frame.stamp_ns = count_++ * kNsPerSecond / 30;
    cv::Mat bgr;
    cv::cvtColor(color_, bgr, cv::COLOR_GRAY2BGR);
    frame.color = bgr;
    frame.depth_m = depth_m_.clone();
    return region_.observe(front_end_.prepare(frame));
  }

  FrontEnd front_end_{test::sensor_of(test::qvga_camera()), {}};
  CameraFixedRegion region_;
  Random random_{1};
  uint32_t count_ = 0;
  cv::Mat color_, depth_m_;
};

const cv::Rect kPart(0, 180, kWidth, 60);  // a quarter

TEST_F(CameraFixed, APartInFrontOfTheLensIsFoundWithItsBounds) {
  int growths = 0;
  for (int i = 0; i < 60; ++i) {
    look(6.0 * i);
    paint(kPart, 0.6F);
    growths += observe() ? 1 : 0;
  }
  EXPECT_GE(growths, 1);
  EXPECT_NEAR(region_.share(), 0.25, 0.02);
  EXPECT_EQ(region_.unchanged_since_ns(), 0);
  ASSERT_GT(region_.points().rows, kPart.y / 5);
  for (int y = 0; y < region_.points().rows; ++y) {
    const int expected = 5 * y + 2 >= kPart.y ? 255 : 0;
    if (std::abs(5 * y + 2 - kPart.y) <= 5) continue;
    EXPECT_EQ(region_.points().at<uint8_t>(y, 30), expected) << y;
  }
}

TEST_F(CameraFixed, NothingIsFixedInARoomThatMovesOrRests) {
  for (int i = 0; i < 60; ++i) {
    look(6.0 * i);
    EXPECT_FALSE(observe());
  }
  for (int i = 0; i < 60; ++i) {
    look(360);
    EXPECT_FALSE(observe());
  }
  EXPECT_EQ(region_.share(), 0);
  EXPECT_TRUE(region_.points().empty());
}

TEST_F(CameraFixed, AWallWithoutStructureIsNot) {
  for (int i = 0; i < 60; ++i) {
    look(6.0 * i);
    paint({0, 0, kWidth, 80}, 2.0F, false);
    EXPECT_FALSE(observe());
  }
}

TEST_F(CameraFixed, SomebodyBeforeACameraAtRestDoesNotMakeTheRoomFixed) {
  for (int i = 0; i < 120; ++i) {
    look(0);
    paint({2 * i, 40, 80, 200}, 1.5F);  // a third of the image
    EXPECT_FALSE(observe()) << i;
  }
}

TEST_F(CameraFixed, WhatGoesAwayIsForgotten) {
  for (int i = 0; i < 120; ++i) {
    look(6.0 * i);
    if (i < 60) paint({100, 60, 120, 100}, 0.6F);
    observe();
    if (i == 59) {
      EXPECT_GT(region_.share(), 0.1);
    }
  }
  EXPECT_EQ(region_.share(), 0);
}

TEST_F(CameraFixed, WhatComesLaterIsFixedSinceThen) {
  for (int i = 0; i < 90; ++i) {
    look(6.0 * i);
    if (i >= 30) paint({100, 60, 120, 100}, 0.6F);
    const bool first = region_.share() == 0;
    if (!observe() || !first) continue;
    EXPECT_GT(i, 40);
    EXPECT_NEAR(to_seconds(region_.unchanged_since_ns()), 1.0, 0.1);
  }
  EXPECT_NEAR(region_.share(), 120 * 100 / double{kWidth * kHeight}, 0.03);
}

}  // namespace
}  // namespace kinloop
