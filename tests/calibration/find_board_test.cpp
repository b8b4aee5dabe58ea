#include "tools/calibration/board/find_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/calibration/pictures.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::infrared_camera;
using test::input_error;
using test::largest_error_px;
using test::picture;
using test::small_board;
using test::usage_error;
using testing::AllOf;
using testing::HasSubstr;

SE3 some_pose() {
  return test::board_at({0.02, -0.01, 0.5}, {0.3, -0.3, 0.2}, small_board());
}

TEST(FindBoard, FindsCornersToATenthOfAPixel) {
  const cv::Mat drawn = picture(infrared_camera(), some_pose(), small_board());
  cv::Mat gray;
  drawn.convertTo(gray, CV_8UC1, 180, 40);
  const auto view = find_board(gray, small_board());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->width, 512);
  EXPECT_EQ(view->pixels.size(), 35U);
  EXPECT_LT(largest_error_px(*view, test::view_of(infrared_camera(), some_pose(), small_board(), "")), 0.12);
}

TEST(FindBoard, SeesInfraredWhateverItsLevel) {
  const cv::Mat drawn = picture(infrared_camera(), some_pose(), small_board());
  for (const double level : {300.0, 5000.0, 60000.0}) {
    cv::Mat infrared;
    drawn.convertTo(infrared, CV_16UC1, 0.7 * level, 0.1 * level);
    const auto view = find_board(infrared, small_board());
    ASSERT_TRUE(view) << level;
    EXPECT_LT(largest_error_px(*view, test::view_of(infrared_camera(), some_pose(), small_board(), "")),
              0.12);
  }
}

TEST(FindBoard, IsNothingWithoutAWholeBoard) {
  EXPECT_FALSE(find_board(cv::Mat(424, 512, CV_8UC1, cv::Scalar(90)), small_board()));
  const cv::Mat drawn =
      picture(infrared_camera(), test::board_at({0.3, 0, 0.5}, {0, 0, 0}, small_board()), small_board());
  cv::Mat gray;
  drawn.convertTo(gray, CV_8UC1, 180, 40);
  EXPECT_FALSE(find_board(gray, small_board()));
}

TEST(FindBoards, NamesImagesWithoutABoardAndRefusesMixedSizes) {
  const test::TempFolder folder;
  cv::Mat gray;
  picture(infrared_camera(), some_pose(), small_board()).convertTo(gray, CV_8UC1, 180, 40);
  cv::imwrite((folder.path() / "1.png").string(), gray);
  cv::imwrite((folder.path() / "2.png").string(), cv::Mat(424, 512, CV_8UC1, cv::Scalar(90)));
  size_t told = 0;
  const auto tell = [&](const ProgressReport& now) {
    told = now.done;
    return true;
  };
  const BoardSearch search = find_boards(list_stills(folder.path()), small_board(), 2, tell);
  EXPECT_EQ(told, 2U);
  ASSERT_EQ(search.views.size(), 1U);
  EXPECT_EQ(search.views[0].name, "1.png");
  EXPECT_THAT(search.without_board, testing::ElementsAre("2.png"));
  cv::Mat larger;
  cv::resize(gray, larger, {640, 530});
  cv::imwrite((folder.path() / "3.png").string(), larger);
  EXPECT_THAT(input_error([&] { find_boards(list_stills(folder.path()), small_board(), 1); }),
              AllOf(HasSubstr("3.png"), HasSubstr("640 x 530"), HasSubstr("1.png")));
}

TEST(FindBoards, SaysWhatIsWrongWithTheFolder) {
  const test::TempFolder folder;
  EXPECT_THAT(input_error([&] { list_stills(folder.path()); }), HasSubstr("no PNG or JPEG"));
  EXPECT_THAT(input_error([&] { list_stills(folder.path() / "absent"); }), HasSubstr("absent"));
  folder.write("broken.png", "no image");
  EXPECT_THAT(input_error([&] { find_boards(list_stills(folder.path()), small_board(), 1); }),
              HasSubstr("broken.png"));
  cv::imwrite((folder.path() / "broken.png").string(), cv::Mat(50, 50, CV_8UC1, cv::Scalar(9)));
  EXPECT_THAT(input_error([&] { find_boards(list_stills(folder.path()), small_board(), 1); }),
              HasSubstr("5 x 7 inner corners not found in any of 1 images"));
}

TEST(ParseBoard, TakesInnerCorners) {
  const Board board = parse_board("5x7", 0.03);
  EXPECT_EQ(board.columns, 5);
  EXPECT_EQ(board.rows, 7);
  EXPECT_TRUE(board.has_180_degree_symmetry());
  EXPECT_FALSE(parse_board("5x8", 0.03).has_180_degree_symmetry());
  for (const char* wrong : {"", "5", "5x", "x7", "5x2", "5x7x9", "5 x 7", "-5x7"}) {
    EXPECT_THAT(usage_error([&] { parse_board(wrong, 0.03); }), HasSubstr("inner corners")) << wrong;
  }
  EXPECT_THAT(usage_error([] { parse_board("5x7", 0); }), HasSubstr("--square"));
}

/// The images of a real Kinect 2, compared with another tool's result (reference_color.yaml).
TEST(RealKinect2, ColorIsTheReferencesWithinItsDeviations) {
  const auto folder = test::shared_data("kinect2_checkerboard/sync");
  KINLOOP_SKIP_WITHOUT(folder);
  const BoardSearch infrared = find_boards(list_stills(folder, "_ir.png"), small_board(), 2);
  EXPECT_EQ(infrared.views.size(), 10U) << "boards behind a reflection are found, too";
  const BoardSearch color = find_boards(list_stills(folder, "_colour.jpg"), small_board(), 2);
  EXPECT_EQ(color.views.size(), 10U);
  const LensCalibration c = calibrate_lens(color.views);
  EXPECT_LT(c.rms_px, 0.15);
  EXPECT_NEAR(c.camera.fx, 1067.46, 3 * c.std_deviations()(0));
  EXPECT_NEAR(c.camera.fy, 1069.91, 3 * c.std_deviations()(1));
}

}  // namespace
}  // namespace kinloop
