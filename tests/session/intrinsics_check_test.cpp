#include <gmock/gmock.h>

#include "session/input/checks/checks.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A Kinect of 640 x 480 with all intrinsics times `factor`.
PinholeCamera camera(double factor) {
  return {640, 480, factor * 525, factor * 525, factor * 319.5, factor * 239.5, {}};
}

std::string text(const PinholeCamera& camera) {
  const auto warning = check_intrinsics(camera);
  return warning ? text_of(*warning) : "";
}

TEST(IntrinsicsCheck, SaysNothingOfUsualCameras) {
  EXPECT_EQ(text(camera(1)), "");
  EXPECT_EQ(text({1920, 1080, 1081, 1081, 959.5, 539.5, {}}), "");  // Kinect 2
  EXPECT_EQ(text({640, 480, 517.3, 516.5, 318.6, 255.3, {}}), "");  // TUM freiburg1
  EXPECT_EQ(text({640, 480, 612, 612, 338, 220, {}}), "");          // 3 % off the middle
}

TEST(IntrinsicsCheck, NamesTheShareThatFits) {
  EXPECT_THAT(text(camera(2)), AllOf(HasSubstr("(639.0, 479.0)"), HasSubstr("640 x 480"),
                                     HasSubstr("half of all values"), HasSubstr("fx 525.0")));
  EXPECT_THAT(text(camera(0.5)), HasSubstr("the double of all values fits these images: fx 525.0"));
  EXPECT_THAT(text(camera(0.25)), HasSubstr("four times of all values"));
  EXPECT_THAT(text(camera(1.7)), HasSubstr("0.59 times of all values"));
}

TEST(IntrinsicsCheck, NamesTheDepthCameraOfScanNet) {
  EXPECT_THAT(text({1296, 968, 577.87, 577.87, 319.5, 239.5, {}}), HasSubstr("the double of all values"));
}

TEST(IntrinsicsCheck, NamesAPrincipalPointInTheCorner) {
  PinholeCamera corner = camera(1);
  corner.cx = corner.cy = 0;
  EXPECT_THAT(text(corner), AllOf(HasSubstr("(0.0, 0.0) is far from the middle"), HasSubstr("cx 319.5")));
}

TEST(IntrinsicsCheck, NamesAnImpossibleFieldOfView) {
  PinholeCamera narrow = camera(1), wide = camera(1);
  narrow.fx = narrow.fy = 5250;
  wide.fx = wide.fy = 52.5;
  EXPECT_THAT(text(narrow), HasSubstr("7 degrees"));
  EXPECT_THAT(text(wide), HasSubstr("161 degrees"));
}

}  // namespace
}  // namespace kinloop
