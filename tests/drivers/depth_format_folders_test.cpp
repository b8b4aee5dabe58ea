// Folders of images whose depth is in each of the formats of docs/recordings.md.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/datasets/open_sequence.hpp"
#include "tests/drivers/depth_file_samples.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::TempFolder;
using testing::HasSubstr;

constexpr int kRow = 3, kColumn = 5, kDepth_mm = 1700;

/// Depth of a room with many different values.
cv::Mat room_mm(cv::Size size) {
  cv::Mat depth(size, CV_16UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      depth.at<uint16_t>(y, x) = static_cast<uint16_t>(1200 + 7 * x + 11 * y);
  }
  depth.at<uint16_t>(kRow, kColumn) = kDepth_mm;
  return depth;
}

/// rgb/ with PNG images of 32 x 24 and depth/ in one of the formats, and a camera without a unit of depth.
class DepthFolder : public testing::TestWithParam<test::DepthFormat> {
 protected:
  void write(const test::DepthFormat& format, cv::Size size = {32, 24}) const {
    for (int i = 0; i < 3; ++i) {
      folder_.write(fmt::format("rgb/{}.png", i), test::encoded(test::make_color(i), ".png"));
      folder_.write(fmt::format("depth/{}{}", i, format.ending), format.write(room_mm(size)));
    }
    folder_.write("K.txt", "25 0 15.5\n0 25 11.5\n0 0 1\n");
  }

  TempFolder folder_;
};

TEST_P(DepthFolder, IsReadInMetres) {
  write(GetParam());
  const auto source = open_sequence(folder_.path().string());
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_FLOAT_EQ(frame->depth_m.at<float>(kRow, kColumn), 1e-3F * kDepth_mm);
  }
  EXPECT_TRUE(source->skipped().empty());
}

TEST_P(DepthFolder, OfASmallerSizeIsTheSameView) {
  write(GetParam(), {16, 12});
  const auto source = open_sequence(folder_.path().string());
  ASSERT_TRUE(source->camera().depth);
  EXPECT_EQ(source->camera().depth->width, 16);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth_m.size(), cv::Size(32, 24));
  EXPECT_GT(frame->depth_m.at<float>(12, 16), 1.2F);
}

TEST_P(DepthFolder, MayBeDamagedInAFrame) {
  write(GetParam());
  const std::string whole = GetParam().write(room_mm({32, 24}));
  folder_.write(fmt::format("depth/1{}", GetParam().ending), whole.substr(0, whole.size() / 2));
  const auto source = open_sequence(folder_.path().string());
  EXPECT_TRUE(source->next());
  EXPECT_TRUE(source->next());
  EXPECT_FALSE(source->next());
  ASSERT_EQ(source->skipped().size(), 1U);
  EXPECT_THAT(source->skipped().front().reason, HasSubstr(fmt::format("depth/1{}: ", GetParam().ending)));
}

TEST_P(DepthFolder, OfAnotherSizeInAFrameNamesBothSizes) {
  write(GetParam());
  folder_.write(fmt::format("depth/1{}", GetParam().ending), GetParam().write(room_mm({16, 12})));
  const auto source = open_sequence(folder_.path().string());
  while (source->next()) continue;
  ASSERT_EQ(source->skipped().size(), 1U);
  EXPECT_THAT(source->skipped().front().reason, HasSubstr("16 x 12 pixels where the camera has 32 x 24"));
}

INSTANTIATE_TEST_SUITE_P(Formats, DepthFolder, testing::ValuesIn(test::depth_formats()),
                         [](const auto& format) {
                           std::string name = format.param.name;
                           std::erase_if(name, [](unsigned char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

TEST_F(DepthFolder, WithACameraYamlMayBeSmallerToo) {
  write(test::depth_formats().front(), {16, 12});
  folder_.write("camera.yaml", test::kSmallCamera);
  const auto source = open_sequence(folder_.path().string());
  ASSERT_TRUE(source->camera().depth);
  EXPECT_EQ(source->camera().depth->fx, 12.5);
}

TEST_F(DepthFolder, OfAnotherAspectIsAnErrorThatNamesBothSizes) {
  write(test::depth_formats().front(), {16, 16});
  EXPECT_THAT(
      test::input_error([&] { static_cast<void>(open_sequence(folder_.path().string())); }),
      testing::AllOf(HasSubstr("16 x 16 pixels where the camera has 32 x 24"), HasSubstr("its own camera")));
}

TEST_F(DepthFolder, OfFloatsIsInTheUnitThatIsGiven) {
  write(test::DepthFormat{"", ".npy", [](const cv::Mat& mm) {
                            cv::Mat centimetres;
                            mm.convertTo(centimetres, CV_32FC1, 0.1);
                            return test::numpy(centimetres);
                          }});
  const auto frame = open_sequence(folder_.path().string(), {}, 100)->next();
  ASSERT_TRUE(frame);
  EXPECT_FLOAT_EQ(frame->depth_m.at<float>(kRow, kColumn), 1e-3F * kDepth_mm);
}

TEST_F(DepthFolder, OfFloatsInMetresIsMetricUnlessAnotherUnitIsGiven) {
  write(test::DepthFormat{"", ".npy", [](const cv::Mat& mm) {
                            cv::Mat metres;
                            mm.convertTo(metres, CV_32FC1, 0.001);
                            return test::numpy(metres);
                          }});
  EXPECT_TRUE(open_sequence(folder_.path().string())->camera().has_metric_depth);
  EXPECT_FALSE(open_sequence(folder_.path().string(), {}, 1)->camera().has_metric_depth);
}

TEST_F(DepthFolder, SideBySideMayBeExr) {
  const test::DepthFormat& exr = test::depth_formats()[2];
  for (int i = 8; i < 12; ++i) {  // without padding
    folder_.write(fmt::format("color_{}.jpg", i), test::encoded(test::make_color(i), ".png"));
    if (i != 10) folder_.write(fmt::format("depth_{}.exr", i), exr.write(room_mm({32, 24})));
  }
  folder_.write("K.txt", "25 0 15.5\n0 25 11.5\n0 0 1\n");
  const auto opened = read_sequence(folder_.path());
  ASSERT_EQ(opened.sequence.frames.size(), 3U);
  EXPECT_EQ(opened.sequence.frames[2].color.file.filename(), "color_11.jpg");
  EXPECT_EQ(opened.sequence.frames[2].depth.file.filename(), "depth_11.exr");
  EXPECT_EQ(opened.sequence.skipped.size(), 1U);
}

}  // namespace
}  // namespace kinloop
