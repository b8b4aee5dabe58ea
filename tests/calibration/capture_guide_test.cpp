#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/calibration/pictures.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/calibration/board/find_board.hpp"
#include "tools/calibration/capture.hpp"

namespace kinloop {
namespace {

using test::board_at;
using test::color_camera;
using test::infrared_camera;
using test::input_error;
using test::small_board;
using testing::HasSubstr;

constexpr double kSharpPx = 2;

BoardView seen_at(const SE3& T_camera_board) {
  return test::view_of(color_camera(), T_camera_board, small_board(), "");
}

/// A board in the centre, at arm's length, facing the camera except for `tilt`.
SE3 tilted(double about_x, double about_y) {
  return board_at({0, 0, 0.45}, {about_x, about_y, 0}, small_board());
}

TEST(CaptureGuide, EstimatesTheBoardPlacement) {
  const auto placement = placement_of(seen_at(tilted(0, 0.5)));
  ASSERT_TRUE(placement);
  EXPECT_NEAR(std::abs(placement->tilt_deg.x()), 28.6, 10);
  EXPECT_NEAR(placement->tilt_deg.y(), 0, 8);
  const auto right_away = [](const BoardView& view) {
    const auto side = [&](size_t a, size_t b) { return (view.pixels[a] - view.pixels[b]).norm(); };
    return side(0, 30) > side(4, 34);  // the left column of corners appears longer than the right one
  };
  EXPECT_EQ(placement->tilt_deg.x() > 0, right_away(seen_at(tilted(0, 0.5))));
  EXPECT_NEAR(placement->center.x(), 0.51, 0.03);
}

TEST(CaptureGuide, KeepsAStationaryBoardOnce) {
  CaptureGuide guide(20);
  EXPECT_THAT(guide.advise(std::nullopt, 0).hint, HasSubstr("show the board (0 of 20)"));
  EXPECT_THAT(guide.advise(seen_at(tilted(0, 0)), kSharpPx).hint, HasSubstr("hold the board still"));
  EXPECT_FALSE(guide.advise(seen_at(tilted(0.3, 0)), kSharpPx).keep) << "the board moves";
  EXPECT_FALSE(guide.advise(seen_at(tilted(0.3, 0)), 8).keep) << "blurred";
  const CaptureAdvice advice = guide.advise(seen_at(tilted(0.3, 0)), kSharpPx);
  EXPECT_TRUE(advice.keep);
  EXPECT_THAT(advice.hint, HasSubstr("1 of 20"));
  EXPECT_FALSE(guide.advise(seen_at(tilted(0.3, 0)), kSharpPx).keep) << "the same view again";
  EXPECT_EQ(guide.kept(), 1U);
}

/// Follows the hint, slightly differently each time.
SE3 pose_for(const std::string& hint, Random& random) {
  const double angle = random.uniform(0.35, 0.7), other = random.uniform(-0.2, 0.2);
  if (hint.find("left edge of the board") != std::string::npos) return tilted(other, angle);
  if (hint.find("right edge of the board") != std::string::npos) return tilted(other, -angle);
  if (hint.find("upper edge of the board") != std::string::npos) return tilted(-angle, other);
  if (hint.find("lower edge of the board") != std::string::npos) return tilted(angle, other);
  if (hint.find("closer") != std::string::npos) {
    const double x = random.uniform(-0.04, 0.04);
    return board_at({x, 0, 0.24}, {other, angle - 0.4, 0}, small_board());
  }
  if (hint.find("corner") != std::string::npos) {
    const double x = hint.find("left") != std::string::npos ? -0.34 : 0.32;
    const double y = hint.find("upper") != std::string::npos ? -0.14 : 0.14;
    return board_at({x, y, 0.45}, {other, angle - 0.4, 0}, small_board());
  }
  return test::random_pose(random, small_board());
}

TEST(CaptureGuide, FollowingItsHintsConstrainsTheIntrinsics) {
  CaptureGuide guide(20);
  Random random(5);
  std::vector<BoardView> kept;
  std::string hint;
  for (int i = 0; i < 200 && !guide.finished(); ++i) {
    BoardView view = seen_at(pose_for(hint, random));
    test::add_noise(view, 0.1, random);
    view.name = fmt::format("still{}", i);
    guide.advise(view, kSharpPx);
    const CaptureAdvice advice = guide.advise(view, kSharpPx);
    if (advice.keep) kept.push_back(view);
    hint = advice.hint;
  }
  ASSERT_TRUE(guide.finished()) << hint;
  EXPECT_GE(kept.size(), 20U);
  EXPECT_THAT(hint, HasSubstr("done ("));
  const LensCalibration c = calibrate_lens(kept);
  EXPECT_THAT(c.warnings, testing::IsEmpty());
  EXPECT_NEAR(c.camera.fx, color_camera().fx, 0.005 * color_camera().fx);
}

/// A frame of both cameras, with optional blur of the colour image.
Frame shot(double blur_px = 0) {
  const SE3 at = board_at({0.02, -0.01, 0.5}, {0.3, -0.3, 0.2}, small_board());
  const cv::Mat drawn = test::picture(infrared_camera(), at, small_board());
  cv::Mat gray = test::in_8_bits(drawn);
  if (blur_px > 0) cv::GaussianBlur(gray, gray, {}, blur_px);
  cv::Mat color;
  cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  Frame frame;
  frame.color = color;
  drawn.convertTo(frame.infrared, CV_16UC1, 9000, 500);
  frame.depth_m = cv::Mat(gray.size(), CV_32FC1, cv::Scalar(0.5));
  return frame;
}

TEST(EdgeWidth, GrowsWithTheBlur) {
  const auto width = [](double blur_px) {
    const Frame frame = shot(blur_px);
    const auto found = find_board(frame.color.bgr(), small_board());
    return found ? edge_width_px(frame.color.bgr(), *found) : 0;
  };
  EXPECT_NEAR(width(0), 2, 0.3);
  EXPECT_NEAR(width(2), 5.4, 1);
}

TEST(StillCapture, WritesPairsOfBothCameras) {
  const test::TempFolder folder;
  StillCapture capture(folder.path() / "stills", small_board(), StillKind::kPairs, 20);
  EXPECT_FALSE(capture.process(shot()).kept);
  const CaptureFeedback feedback = capture.process(shot());
  EXPECT_TRUE(feedback.kept);
  ASSERT_TRUE(feedback.view);
  EXPECT_EQ(feedback.view->pixels.size(), 35U);
  EXPECT_EQ(list_stills(folder.path() / "stills").size(), 3U);
  EXPECT_EQ(read_still(folder.path() / "stills/0001_color.png").type(), CV_8UC3);
  EXPECT_EQ(read_still(folder.path() / "stills/0001_ir.png").type(), CV_16UC1);
  EXPECT_EQ(read_still(folder.path() / "stills/0001_depth.png").at<uint16_t>(3, 3), 500);

  Frame reflecting = shot();
  reflecting.infrared.setTo(cv::Scalar(60000));
  EXPECT_THAT(capture.process(reflecting).hint, HasSubstr("infrared"));
  reflecting.infrared.release();
  EXPECT_THAT(input_error([&] { capture.process(reflecting); }), HasSubstr("no infrared"));
}

TEST(StillCapture, RequiresAnEmptyFolder) {
  const test::TempFolder folder;
  folder.write("stills/0001.png", "older");
  EXPECT_THAT(
      input_error([&] { StillCapture(folder.path() / "stills", small_board(), StillKind::kColor, 20); }),
      HasSubstr("not empty"));
}

}  // namespace
}  // namespace kinloop
