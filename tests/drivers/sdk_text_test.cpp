// The texts in recordings of the RealSense SDK; tests/scripts/realsense_test.py reads whole files of the SDK.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/ros/realsense_bag.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kLens =
    "width=96;height=72;fx=60.5;ppx=47.5;fy=61;ppy=35.5;model=Brown Conrady;coeffs=0.1,0,-2e-3,0,0";

TEST(SdkText, GivesTheLens) {
  const RosCameraInfo info = sdk_camera_info(kLens);
  EXPECT_EQ(info.width, 96);
  EXPECT_EQ(info.height, 72);
  EXPECT_EQ(info.distortion_model, "Brown Conrady");
  EXPECT_THAT(info.D, ElementsAre(0.1, 0, -2e-3, 0, 0));
  EXPECT_THAT(info.K, ElementsAre(60.5, 0, 47.5, 0, 61, 35.5, 0, 0, 1));
}

TEST(SdkText, RotationsAreWrittenByColumns) {
  const SE3 pose = sdk_pose("rotation=0,1,0,-1,0,0,0,0,1;translation=1,2,3");
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
}

TEST(SdkText, StampsAreExactToAMicrosecond) {
  EXPECT_NEAR(static_cast<double>(sdk_stamp_ns("Frame number=7;timestamp=1700000000033.333252;") -
                                  1700000000033333252),
              0, 500);
  EXPECT_EQ(sdk_stamp_ns("timestamp=12.25"), 12'250'000);
}

TEST(SdkText, ImpossibleTextIsAnInputError) {
  EXPECT_THAT(input_error([] { sdk_camera_info("width=96;;=;height"); }), HasSubstr("height"));
  EXPECT_THAT(input_error([] { sdk_camera_info("width=1e99;height=72"); }), HasSubstr("size"));
  EXPECT_THAT(input_error([] { sdk_number("nan"); }), HasSubstr("number"));
  EXPECT_THAT(input_error([] { sdk_number(""); }), HasSubstr("number"));
  for (const char* pose :
       {"rotation=1,0,0,0,1,0,0,0;translation=0,0,0", "rotation=1,0,0,0,1,0,0,0,-1;translation=0,0,0",
        "rotation=2,0,0,0,1,0,0,0,1;translation=0,0,0"}) {
    EXPECT_THAT(input_error([&] { sdk_pose(pose); }), HasSubstr("rigid")) << pose;
  }
  EXPECT_THAT(input_error([] { sdk_stamp_ns("timestamp=1e300"); }), HasSubstr("timestamp"));
}

}  // namespace
}  // namespace kinloop
