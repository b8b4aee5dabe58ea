#include "tools/calibration/board/charuco.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibration/pictures.hpp"
#include "tests/support/expect_error.hpp"
#include "tools/calibration/board/find_board.hpp"

#ifdef KINLOOP_WITH_ARUCO

#include <opencv2/aruco/charuco.hpp>

namespace kinloop {
namespace {

using test::in_8_bits;
using test::infrared_camera;
using test::usage_error;
using testing::HasSubstr;

Board charuco_board(const std::string& dictionary = "DICT_4X4_50") {
  return parse_board("charuco:7x5:" + dictionary, 0.04, 0.028);
}

/// Draws the board; parts for which `hidden` returns true are grey.
template <class Hidden>
cv::Mat charuco_picture(const SE3& T_camera_board, const Hidden& hidden) {
  constexpr int kSquarePx = 80;
  const Board board = charuco_board();
  const int columns = board.columns + 1, rows = board.rows + 1;
  cv::Mat drawn;
  cv::aruco::CharucoBoard::create(columns, rows, 0.04F, 0.028F,
                                  cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50))
      ->draw({columns * kSquarePx, rows * kSquarePx}, drawn);
  return in_8_bits(test::render_plane(infrared_camera(), T_camera_board, [&](double x, double y) {
    if (hidden(x, y)) return 0.5F;
    const double column = kSquarePx * (x / board.square_m + 1), row = kSquarePx * (y / board.square_m + 1);
    if (column < 0 || row < 0 || column >= drawn.cols || row >= drawn.rows) return 1.0F;
    return drawn.at<uint8_t>(static_cast<int>(row), static_cast<int>(column)) > 127 ? 1.0F : 0.0F;
  }));
}

const auto kNothing = [](double, double) { return false; };

SE3 pose(const Eigen::Vector3d& tilt) {
  return test::board_at({0.02, -0.01, 0.4}, tilt, charuco_board());
}

BoardView truth(const SE3& T_camera_board) {
  return test::view_of(infrared_camera(), T_camera_board, charuco_board(), "");
}

TEST(Charuco, FindsEveryCornerToATenthOfAPixel) {
  const SE3 at = pose({0.3, -0.3, 0.2});
  const auto view = find_board(charuco_picture(at, kNothing), charuco_board());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->pixels.size(), 24U);
  EXPECT_LT(test::largest_error_px(*view, truth(at)), 0.15);
}

TEST(Charuco, KnowsEachCornerOfAPartOfTheBoard) {
  const SE3 at = pose({0.3, -0.3, 0.2});
  const auto whole = find_board(charuco_picture(at, kNothing), charuco_board());
  const auto view =
      find_board(charuco_picture(at, [](double x, double) { return x > 0.11; }), charuco_board());
  ASSERT_TRUE(whole && view);
  EXPECT_GE(view->pixels.size(), 8U);
  EXPECT_LT(view->pixels.size(), 20U);
  for (size_t i = 0; i < view->pixels.size(); ++i) {
    const auto same = std::find(whole->board_m.begin(), whole->board_m.end(), view->board_m[i]);
    ASSERT_NE(same, whole->board_m.end());
    const auto place = static_cast<size_t>(same - whole->board_m.begin());
    EXPECT_LT((view->pixels[i] - whole->pixels[place]).norm(), 0.05);
  }
}

TEST(Charuco, CalibratesFromPartsOfTheBoard) {
  std::vector<BoardView> views;
  for (int i = 0; i < 5; ++i) {
    const double side = 1.26 * i;
    const SE3 at = pose({0.5 * std::cos(side), 0.5 * std::sin(side), 0.1 * i});
    const auto hidden = [&](double x, double y) { return i % 2 == 0 ? x > 0.15 : y > 0.09; };
    auto view = find_board(charuco_picture(at, hidden), charuco_board());
    ASSERT_TRUE(view) << i;
    views.push_back(std::move(*view));
  }
  const LensCalibration c = calibrate_lens(views);
  EXPECT_TRUE(c.rejected.empty());
  EXPECT_LT(c.rms_px, 0.1);
  EXPECT_NEAR(c.camera.fx, infrared_camera().fx, 0.02 * infrared_camera().fx);
  EXPECT_NEAR(c.camera.cy, infrared_camera().cy, 5);
}

TEST(Charuco, IsNothingWithTheWrongDictionaryOrTooFewMarkers) {
  const SE3 at = pose({0.2, 0.2, 0});
  EXPECT_FALSE(find_board(charuco_picture(at, kNothing), charuco_board("DICT_6X6_50")));
  EXPECT_FALSE(find_board(charuco_picture(at, [](double x, double) { return x > 0.01; }), charuco_board()));
  EXPECT_FALSE(find_board(cv::Mat(424, 512, CV_8UC1, cv::Scalar(90)), charuco_board()));
}

TEST(ParseBoard, TakesSquaresAndDictionaryOfACharucoBoard) {
  const Board board = charuco_board();
  EXPECT_EQ(board.columns, 6);
  EXPECT_EQ(board.rows, 4);
  EXPECT_EQ(board.dictionary, "DICT_4X4_50");
  EXPECT_FALSE(board.has_180_degree_symmetry());
  for (const char* wrong : {"charuco:", "charuco:7x5", "charuco:7x5:", "charuco:3x3:DICT_4X4_50"}) {
    EXPECT_THAT(usage_error([&] { parse_board(wrong, 0.04, 0.028); }), HasSubstr("charuco:7x5")) << wrong;
  }
  for (const double marker : {0.0, 0.04}) {
    EXPECT_THAT(usage_error([&] { parse_board("charuco:7x5:DICT_4X4_50", 0.04, marker); }),
                HasSubstr("--marker"));
  }
  EXPECT_THAT(usage_error([] { require_charuco(charuco_board("DICT_3X3")); }), HasSubstr("DICT_7X7_1000"));
  EXPECT_THAT(usage_error([] { require_charuco(parse_board("charuco:20x20:DICT_4X4_50", 0.04, 0.02)); }),
              HasSubstr("200 markers"));
}

}  // namespace
}  // namespace kinloop

#else

TEST(Charuco, IsReportedAsMissingFromTheBuild) {
  EXPECT_FALSE(kinloop::charuco_available());
  EXPECT_THAT(kinloop::test::usage_error([] { kinloop::require_charuco({}); }),
              testing::HasSubstr("libopencv-contrib-dev"));
}

#endif
