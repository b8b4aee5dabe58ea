#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/calibration/pictures.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/calibration/board/find_board.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::small_board;
using test::usage_error;
using testing::HasSubstr;

cv::Mat still_of(const Board& board, const Eigen::Vector3d& tilt) {
  PinholeCamera camera;  // fast to draw without distortion
  camera.width = 512, camera.height = 424;
  camera.fx = camera.fy = 366, camera.cx = 255, camera.cy = 211;
  return test::in_8_bits(test::picture(camera, test::board_at({0.01, 0, 0.5}, tilt, board), board));
}

/// A folder with images of a board, tilted in different directions.
class BoardSizes : public testing::Test {
 protected:
  void write_stills(const Board& board) {
    const std::vector<Eigen::Vector3d> tilts = {
        {0.3, 0, 0}, {0, 0.3, 0.1}, {-0.2, 0.2, 0}, {0.1, -0.3, -0.1}};
    for (size_t i = 0; i < tilts.size(); ++i)
      cv::imwrite((folder_.path() / (std::to_string(i) + ".png")).string(), still_of(board, tilts[i]));
  }
  [[nodiscard]] std::optional<BoardSize> other_than(const std::string& board) const {
    return detect_other_board_size(list_stills(folder_.path()), parse_board(board, 0.03), 2);
  }

  const test::TempFolder folder_;
};

TEST_F(BoardSizes, AreSeenInADrawnImage) {
  for (const auto& [text, size] : std::vector<std::pair<const char*, BoardSize>>{
           {"5x7", {5, 7}}, {"8x6", {6, 8}}, {"4x4", {4, 4}}, {"9x3", {3, 9}}}) {
    EXPECT_EQ(detect_board_size(still_of(parse_board(text, 0.025), {0.2, 0.1, 0})), size) << text;
  }
  EXPECT_FALSE(detect_board_size(cv::Mat(424, 512, CV_8UC1, cv::Scalar(90))));
}

TEST_F(BoardSizes, AreNotReportedForTheRightBoard) {
  write_stills(small_board());
  EXPECT_FALSE(other_than("5x7"));
  EXPECT_FALSE(other_than("7x5"));
  for (const char* wrong : {"6x8", "5x8", "9x6", "4x6", "3x3"})
    EXPECT_EQ(other_than(wrong), (BoardSize{5, 7})) << wrong;
}

TEST_F(BoardSizes, AreUndecidedWhereStillsDisagree) {
  cv::imwrite((folder_.path() / "a.png").string(), still_of(small_board(), {0.2, 0, 0}));
  cv::imwrite((folder_.path() / "b.png").string(), still_of(parse_board("4x6", 0.03), {0.2, 0, 0}));
  EXPECT_FALSE(other_than("6x8"));
}

TEST_F(BoardSizes, AreNamedBeforeAllStillsAreSearched) {
  write_stills(small_board());
  size_t done = 0;
  const auto count = [&](const ProgressReport& now) {
    done = now.done;
    return true;
  };
  const std::string message =
      input_error([&] { find_boards(list_stills(folder_.path()), parse_board("6x8", 0.03), 1, count); });
  EXPECT_THAT(message, HasSubstr("no 6x8 board in " + folder_.path().string()));
  EXPECT_THAT(message, HasSubstr("it looks like 5x7: use --board 5x7"));
  EXPECT_EQ(done, 0U);
}

TEST_F(BoardSizes, OfTheRealStillsAreFiveBySeven) {
  const auto stills = test::shared_data("kinect2_checkerboard/colour");
  KINLOOP_SKIP_WITHOUT(stills);
  const auto files = list_stills(stills);
  EXPECT_EQ(detect_other_board_size(files, parse_board("6x8", 0.03), 2), (BoardSize{5, 7}));
  EXPECT_FALSE(detect_other_board_size(files, small_board(), 2));
}

TEST(Square, IsInMetres) {
  EXPECT_THAT(usage_error([] { parse_board("5x7", 30); }), HasSubstr("must be in metres; 30 mm is 0.03"));
  EXPECT_THAT(usage_error([] { parse_board("5x7", 25.4); }), HasSubstr("25.4 mm is 0.0254"));
  EXPECT_THAT(usage_error([] { parse_board("5x7", 3); }), HasSubstr("3 cm is 0.03"));
  EXPECT_EQ(parse_board("5x7", 0.25).square_m, 0.25);
}

}  // namespace
}  // namespace kinloop
