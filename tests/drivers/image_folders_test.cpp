// Folders of images without a list of frames: their names, and which images belong together.

#include <memory>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "kinloop/core/log.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// "rgb/0 depth/0, ...": the pairs of a folder with these files.
std::string pairs_of(const std::vector<std::string>& files, size_t* skipped = nullptr) {
  const TempFolder folder;
  for (const std::string& name : files) folder.write(name, test::encoded(test::make_color(1), ".png"));
  folder.write("camera.yaml", test::kSmallCamera);
  const RecordedSequence sequence = read_sequence(folder.path()).sequence;
  std::string pairs;
  for (const RecordedFrame& frame : sequence.frames)
    pairs += fmt::format("{} {}, ", std::filesystem::relative(frame.color.file, folder.path()).string(),
                         std::filesystem::relative(frame.depth.file, folder.path()).string());
  if (skipped != nullptr) *skipped = sequence.skipped.size();
  return pairs;
}

TEST(FolderNames, OfColourAndDepthMayBeAnyOfTheUsualOnes) {
  for (const char* color : {"rgb", "color", "colors", "image", "images", "imgs", "mono", "gray"}) {
    for (const char* depth : {"depth", "depths", "depth_png"}) {
      EXPECT_EQ(pairs_of({fmt::format("{}/1.png", color), fmt::format("{}/1.png", depth)}),
                fmt::format("{}/1.png {}/1.png, ", color, depth));
    }
  }
}

TEST(FolderNames, MayBeginWithACapital) {
  EXPECT_EQ(pairs_of({"RGB/1.png", "Depth/1.png"}), "RGB/1.png Depth/1.png, ");
}

TEST(FolderNames, AlignedDepthIsTakenWhereBothAre) {
  EXPECT_EQ(pairs_of({"color/1.png", "depth/1.png", "aligned_depth/1.png"}),
            "color/1.png aligned_depth/1.png, ");
}

TEST(FoldersWithoutLists, ColourMayHaveSixteenBitsPerChannel) {
  const TempFolder folder;
  cv::Mat deep;
  test::make_color(1).convertTo(deep, CV_16U, 257);
  folder.write("rgb/1.png", test::encoded(deep, ".png"));
  folder.write("depth/1.png", test::encoded(test::make_depth(1500), ".png"));
  folder.write("camera.yaml", test::kSmallCamera);
  const auto frame = open_sequence(folder.path().string())->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::norm(frame->color.bgr(), test::make_color(1), cv::NORM_INF), 0);
}

/// What is logged when a folder is opened whose colour is 8 bits times `factor`, in 16 bits.
std::string said_of_deep_color(double factor) {
  const TempFolder folder;
  cv::Mat deep;
  test::make_color(1).convertTo(deep, CV_16U, factor);
  folder.write("rgb/1.png", test::encoded(deep, ".png"));
  folder.write("depth/1.png", test::encoded(test::make_depth(1500), ".png"));
  folder.write("camera.yaml", test::kSmallCamera);
  std::ostringstream said;
  auto& sinks = log::default_logger()->sinks();
  sinks.push_back(std::make_shared<spdlog::sinks::ostream_sink_mt>(said));
  static_cast<void>(open_sequence(folder.path().string()));
  sinks.pop_back();
  return said.str();
}

TEST(FoldersWithoutLists, WarnIfColourInSixteenBitsHasOnlyTenOrTwelve) {
  for (const double factor : {4, 16}) EXPECT_THAT(said_of_deep_color(factor), HasSubstr("nearly black"));
  EXPECT_THAT(said_of_deep_color(257), AllOf(HasSubstr("is reduced to 8"), Not(HasSubstr("nearly black"))));
}

/// What a 16-bit image has as plain numbers.
std::string raw(const cv::Mat& depth) {
  return {reinterpret_cast<const char*>(depth.data), depth.total() * depth.elemSize()};
}

TEST(FoldersWithoutLists, RawDepthHasTheSizeOfTheCamera) {
  const TempFolder folder;
  for (int i = 0; i < 3; ++i) {
    folder.write(fmt::format("rgb/{:04}_Color.png", i), test::encoded(test::make_color(i), ".png"));
    folder.write(fmt::format("depth/{:04}_Depth.raw", i),
                 raw(test::make_depth(static_cast<uint16_t>(1500 + i))));
    folder.write(fmt::format("depth/{:04}_Depth.png", i), test::encoded(test::make_color(i), ".png"));
  }
  folder.write("camera.yaml", test::kSmallCamera);
  const auto source = open_sequence(folder.path().string());
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_FLOAT_EQ(frame->depth_m.at<float>(5, 7), 1.5F + 0.001F * static_cast<float>(i));
  }
  for (int i = 0; i < 3; ++i) folder.write(fmt::format("depth/{:04}_Depth.raw", i), "short");
  const auto damaged = open_sequence(folder.path().string());
  EXPECT_THAT(test::input_error([&] { damaged->next(); }),
              HasSubstr("5 bytes where the camera's size needs 1536"));
}

TEST(FoldersWithoutLists, OtherFormatsOfColourAreRead) {
  for (const char* ending : {".ppm", ".bmp", ".tiff"}) {
    SCOPED_TRACE(ending);
    const TempFolder folder;
    for (int i = 0; i < 2; ++i) {
      folder.write(fmt::format("rgb/{}{}", i, ending), test::encoded(test::make_color(i), ending));
      folder.write(fmt::format("depth/{}.pgm", i), test::encoded(test::make_depth(1500), ".pgm"));
    }
    folder.write("camera.yaml", test::kSmallCamera);
    const auto source = open_sequence(folder.path().string());
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(cv::norm(frame->color.bgr(), test::make_color(0), cv::NORM_INF), 0);
    EXPECT_FLOAT_EQ(frame->depth_m.at<float>(5, 7), 1.5F);
  }
}

TEST(FoldersWithoutLists, FormatsThatAreNotReadAreNamed) {
  const TempFolder folder;
  folder.write("rgb/1.heic", "x");
  folder.write("depth/1.png", test::encoded(test::make_depth(1500), ".png"));
  folder.write("camera.yaml", test::kSmallCamera);
  EXPECT_THAT(
      test::input_error([&] { read_sequence(folder.path()); }),
      AllOf(HasSubstr("rgb/ without images that kinloop can read, only .heic"), HasSubstr("convert")));
}

TEST(FolderNames, ArraysOfDepthCountNotThePicturesBesideThem) {
  EXPECT_EQ(
      pairs_of({"images/0.png", "images/1.png", "depth/0.png", "depth/0.npy", "depth/1.png", "depth/1.npy"}),
      "images/0.png depth/0.npy, images/1.png depth/1.npy, ");
}

TEST(FolderWithoutImages, IsThatOfTheOnlySequenceBelow) {
  EXPECT_EQ(pairs_of({"scan/rgb/1.png", "scan/depth/1.png", "docs/figure.png"}),
            "scan/rgb/1.png scan/depth/1.png, ");
}

TEST(SevenScenes, NamesOfItsFilesWithImagesOfAnotherSizeAreThoseOfAnotherCamera) {
  const TempFolder folder;
  for (int i = 0; i < 2; ++i) {
    folder.write(fmt::format("frame-00000{}.color.png", i), test::encoded(test::make_color(i), ".png"));
    folder.write(fmt::format("frame-00000{}.depth.png", i), test::encoded(test::make_depth(1500), ".png"));
  }
  EXPECT_THAT(test::input_error([&] { read_sequence(folder.path()); }), testing::HasSubstr("no camera: "));
  folder.write("K.txt", "25 0 15.5\n0 25 11.5\n0 0 1\n");
  const OpenedSequence opened = read_sequence(folder.path(), {}, 1000);
  EXPECT_EQ(opened.camera.color.width, test::kWidth);
  EXPECT_FALSE(opened.camera.depth);
}

TEST(FlatFolder, IsPairedByTheNamesOfItsImages) {
  EXPECT_EQ(pairs_of({"2_color.png", "2_depth.png", "10_color.png", "10_depth.png"}),
            "2_color.png 2_depth.png, 10_color.png 10_depth.png, ");
  EXPECT_EQ(pairs_of({"a1_rgb.png", "a1_depth.png"}), "a1_rgb.png a1_depth.png, ");
  EXPECT_EQ(pairs_of({"color_0000.png", "depth_0000.png", "color_0001.png", "depth_0001.png"}),
            "color_0000.png depth_0000.png, color_0001.png depth_0001.png, ");
  EXPECT_EQ(pairs_of({"rgb-3.png", "depth-3.png"}), "rgb-3.png depth-3.png, ");
  const TempFolder folder;
  folder.write("color.png", "");
  folder.write("depth.png", "");
  EXPECT_EQ(recognise_layout(folder.path()), nullptr);
}

TEST(FoldersWithoutLists, ImagesOfOneSideAreSkippedAndCounted) {
  size_t skipped = 0;
  EXPECT_EQ(pairs_of({"rgb/1.png", "rgb/2.png", "rgb/10.png", "depth/2.png", "depth/3.png", "depth/10.png"},
                     &skipped),
            "rgb/2.png depth/2.png, rgb/10.png depth/10.png, ");
  EXPECT_EQ(skipped, 2U);
  EXPECT_EQ(pairs_of({"rgb/1-color.png", "rgb/2-color.png", "depth/2-depth.png"}, &skipped),
            "rgb/2-color.png depth/2-depth.png, ");
  EXPECT_EQ(skipped, 1U);
}

}  // namespace
}  // namespace kinloop
