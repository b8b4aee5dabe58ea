// Masks of single frames in folders.

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/open_sequence.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::encoded;
using testing::AllOf;
using testing::HasSubstr;

/// A mask that ignores the first `columns` columns and has `used` elsewhere.
cv::Mat mask_without(int columns, int used = 255, cv::Size size = {test::kWidth, test::kHeight}) {
  cv::Mat mask(size, CV_8UC1, cv::Scalar(used));
  mask.colRange(0, columns) = 0;
  return mask;
}

class FrameMasks : public testing::Test {
 protected:
  void write_mask(int frame, const std::string& bytes) const {
    sequence_.folder.write(fmt::format("masks/{}.png", frame), bytes);
  }

  std::unique_ptr<FrameSource> open() const { return open_sequence(sequence_.path().string()); }

  /// Returns how many pixels the mask of each frame ignores; -1 if it has none.
  [[nodiscard]] std::vector<int> ignored_pixels() const {
    std::vector<int> ignored;
    const auto source = open();
    while (const auto frame = source->next())
      ignored.push_back(frame->mask.empty() ? -1 : cv::countNonZero(frame->mask == 0));
    return ignored;
  }

  const test::SequenceFolder sequence_{4};
};

TEST_F(FrameMasks, AreThoseOfTheSameNameInTumLayout) {
  EXPECT_THAT(ignored_pixels(), testing::ElementsAre(-1, -1, -1, -1));
  write_mask(0, encoded(mask_without(3), ".png"));
  write_mask(2, encoded(mask_without(5, 1), ".png"));  // labels: what is not 0 is used
  write_mask(77, "of no image");
  EXPECT_THAT(ignored_pixels(), testing::ElementsAre(3 * test::kHeight, -1, 5 * test::kHeight, -1));
  EXPECT_THAT(open()->info().description, HasSubstr("masks of 2"));
}

TEST_F(FrameMasks, AreThoseOfTheSameNameInPlainFolders) {
  for (const char* list : {"rgb.txt", "depth.txt"}) std::filesystem::remove(sequence_.path() / list);
  write_mask(1, encoded(mask_without(4), ".png"));
  EXPECT_THAT(ignored_pixels(), testing::ElementsAre(-1, 4 * test::kHeight, -1, -1));
}

TEST_F(FrameMasks, MayIgnoreAWholeFrame) {
  write_mask(0, encoded(mask_without(test::kWidth), ".png"));
  write_mask(1, encoded(mask_without(1), ".png"));
  EXPECT_EQ(ignored_pixels()[0], test::kWidth * test::kHeight);
}

TEST_F(FrameMasks, ThatIgnoreEverythingAreTheWrongWayRound) {
  for (int i = 0; i < 4; ++i) write_mask(i, encoded(mask_without(test::kWidth), ".png"));
  EXPECT_THAT(test::input_error([&] { open(); }), AllOf(HasSubstr("masks"), HasSubstr("must be white")));
}

TEST_F(FrameMasks, OfAnotherSizeAreErrorsThatNameTheFile) {
  const std::string small = encoded(mask_without(1, 255, {16, 12}), ".png");
  write_mask(0, small);
  const auto names_it = AllOf(HasSubstr("0.png"), HasSubstr("16 x 12"), HasSubstr("32 x 24"));
  EXPECT_THAT(test::input_error([&] { open(); }), names_it);
  write_mask(0, encoded(mask_without(1), ".png"));
  write_mask(2, small);
  const auto source = open();
  source->next();
  source->next();
  EXPECT_THAT(test::input_error([&] { source->next(); }), HasSubstr("2.png"));
}

TEST_F(FrameMasks, OfAnotherKindAreErrors) {
  for (const std::string& wrong : {encoded(test::make_color(1), ".png"), encoded(test::make_depth(1), ".png"),
                                   encoded(mask_without(1), ".jpg")}) {
    write_mask(0, wrong);
    EXPECT_THAT(test::input_error([&] { open(); }), AllOf(HasSubstr("0.png"), HasSubstr("8-bit grey PNG")));
  }
}

TEST_F(FrameMasks, ThatAreDamagedSkipTheirFrame) {
  write_mask(0, encoded(mask_without(1), ".png"));
  write_mask(1, encoded(mask_without(1), ".png").substr(0, 50));
  write_mask(3, "");
  const auto source = open();
  int frames = 0;
  while (source->next()) ++frames;
  EXPECT_EQ(frames, 2);
  EXPECT_EQ(source->skipped().size(), 2U);
}

TEST_F(FrameMasks, OfNoFrameAreNotIgnoredSilently) {
  sequence_.folder.write("masks/0.png.png", encoded(mask_without(1), ".png"));
  EXPECT_THAT(test::input_error([&] { open(); }), AllOf(HasSubstr("0.png.png"), HasSubstr("0.png")));
}

}  // namespace
}  // namespace kinloop
