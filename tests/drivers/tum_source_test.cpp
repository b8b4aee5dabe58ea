#include "drivers/datasets/tum_source.hpp"

#include <gmock/gmock.h>

#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::encoded;
using test::input_error;
using test::make_color;
using test::make_depth;
using test::SequenceFolder;
using test::TempFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<Frame> read_all(FrameSource& source) {
  std::vector<Frame> frames;
  while (auto frame = source.next()) frames.push_back(*frame);
  return frames;
}

/// The indices of the delivered frames of a SequenceFolder, recognised by their depth.
std::vector<int> indices(const std::vector<Frame>& frames) {
  std::vector<int> found;
  for (const auto& frame : frames) found.push_back(cvRound(1000 * frame.depth_m.at<float>(0, 0)) - 1000);
  return found;
}

std::string open_error(const std::filesystem::path& folder) {
  return input_error([&] { TumSource source(folder); });
}

TEST(TumSource, ListsWithBackslashesAreRead) {
  const SequenceFolder sequence(2);
  sequence.folder.write("associations.txt",
                        "100 rgb\\0.png 100 depth\\0.png\r\n101 rgb\\1.png 101 depth\\1.png\r\n");
  TumSource source(sequence.path());
  EXPECT_THAT(indices(read_all(source)), ElementsAre(0, 1));
}

TEST(TumSource, SaysWhatIsWrongWithAList) {
  const SequenceFolder sequence(2);
  sequence.folder.write("rgb.txt", "100 rgb/my image.png\n");
  EXPECT_THAT(open_error(sequence.path()), AllOf(HasSubstr("rgb.txt:1"), HasSubstr("must not have blanks")));
  sequence.folder.write("rgb.txt", std::string("\xFF\xFE"
                                               "1\0",
                                               4));
  EXPECT_THAT(open_error(sequence.path()), AllOf(HasSubstr("rgb.txt"), HasSubstr("UTF-16")));
}

TEST(TumSource, SaysWhatIsWrongWithAnImage) {
  const SequenceFolder sequence(1);
  sequence.folder.write(SequenceFolder::color_name(0), std::string("II*\0 a TIFF", 11));
  TumSource tiff(sequence.path());
  EXPECT_THAT(input_error([&] { tiff.next(); }), HasSubstr("rgb/0.png: the file is damaged"));
}

TEST(TumSource, AnImageThatViewersTurnIsRefused) {
  const SequenceFolder sequence(4);
  for (int i = 0; i < 4; ++i) {
    std::string jpeg = encoded(make_color(i), ".jpg");
    const std::string exif(
        "\xff\xe1\0\x22"
        "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
        36);
    sequence.folder.write(SequenceFolder::color_name(i), jpeg.insert(2, exif));
  }
  EXPECT_THAT(open_error(sequence.path()), AllOf(HasSubstr("0.png"), HasSubstr("EXIF orientation is 6")));
}

TEST(TumSource, GivesTheFramesInOrder) {
  const SequenceFolder sequence(4);
  TumSource source(sequence.path());
  EXPECT_EQ(source.info().name, sequence.path().string());
  EXPECT_EQ(source.info().frames, 4U);
  EXPECT_FALSE(source.info().live);
  EXPECT_THAT(source.info().ground_truth, IsEmpty());
  EXPECT_EQ(source.camera().color.fx, 25);
  const auto frames = read_all(source);
  ASSERT_THAT(frames, SizeIs(4));
  for (int i = 0; i < 4; ++i) {
    const auto& frame = frames[static_cast<size_t>(i)];
    EXPECT_EQ(frame.id, FrameId{static_cast<uint32_t>(i)});
    EXPECT_EQ(frame.stamp_ns, *parse_stamp_ns(SequenceFolder::stamp(i)));
    EXPECT_EQ(frame.depth_stamp_ns, *parse_stamp_ns(SequenceFolder::stamp(i, 0.005)));
    EXPECT_EQ(cv::norm(frame.color.bgr(), make_color(i), cv::NORM_INF), 0);
    EXPECT_FLOAT_EQ(frame.depth_m.at<float>(3, 3), 1.0F + 0.001F * static_cast<float>(i));
  }
  EXPECT_THAT(source.skipped(), IsEmpty());
  EXPECT_FALSE(source.next());
}

TEST(TumSource, PassesOverFramesWithoutReadingThem) {
  const SequenceFolder sequence(4);
  TumSource source(sequence.path());
  sequence.folder.write(SequenceFolder::color_name(1), "damaged");
  EXPECT_TRUE(source.next());
  EXPECT_TRUE(source.pass_over());
  EXPECT_THAT(indices(read_all(source)), ElementsAre(2, 3));
  EXPECT_THAT(source.skipped(), IsEmpty());
  EXPECT_FALSE(source.pass_over());
}

TEST(TumSource, AssociationsFileRulesWhereThereIsOne) {
  const SequenceFolder sequence(3);
  sequence.folder.write(
      "associations.txt",
      "# chosen by hand\n100.0 rgb/0.png 107.5 depth/2.png\n101.0 rgb/1.png 100.0 depth/0.png\n");
  testing::internal::CaptureStdout();
  TumSource source(sequence.path());
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("associations.txt:2:"), HasSubstr("0.02 s apart in 2 of 2 pairs")));
  EXPECT_THAT(indices(read_all(source)), ElementsAre(2, 0));
}

TEST(TumSource, ImagesWithoutPartnerAreNotFrames) {
  const SequenceFolder sequence(3);
  sequence.folder.write("depth.txt", "100.0 depth/0.png\n100.067 depth/2.png\n");
  TumSource source(sequence.path());
  EXPECT_EQ(source.info().frames, 2U);
  EXPECT_THAT(indices(read_all(source)), ElementsAre(0, 2));
  EXPECT_THAT(source.skipped(), IsEmpty());
}

TEST(TumSource, GroundTruthComesWithTheSequence) {
  const SequenceFolder sequence(2);
  sequence.folder.write("groundtruth.txt", "# t x y z q\n100.0 1 2 3 0 0 0 1\n100.1 2 2 3 0 0 0 1\n");
  const TumSource source(sequence.path());
  ASSERT_THAT(source.info().ground_truth, SizeIs(2));
  EXPECT_EQ(source.info().ground_truth[1].T_world_camera.translation.x(), 2);
}

TEST(TumSource, GroundTruthWithoutAPoseIsWarnedOf) {
  const SequenceFolder sequence(2);
  sequence.folder.write("groundtruth.txt", "# t x y z q\n");
  testing::internal::CaptureStdout();
  EXPECT_THAT(TumSource(sequence.path()).info().ground_truth, IsEmpty());
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("groundtruth.txt: contains no pose"));
}

TEST(TumSource, RowsOfTheGroundTruthWithoutAPoseAreNoTruth) {
  const SequenceFolder sequence(2);
  sequence.folder.write(
      "groundtruth.txt",
      "# t x y z q\n100.0 1 2 3 0 0 0 1\n100.1 nan NaN -nan nan nan nan nan\n100.2 1 2 3 0 0 0 0\n"
      "100.3 inf 2 3 0 0 0 1\n100.4 2 2 3 0 0 0 1\n");
  testing::internal::CaptureStdout();
  const TumSource source(sequence.path());
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("3 of 5 lines have no pose"));
  EXPECT_THAT(source.info().ground_truth, SizeIs(2));
  sequence.folder.write("groundtruth.txt", "100.0 1 x 3 0 0 0 1\n");
  EXPECT_THAT(open_error(sequence.path()), AllOf(HasSubstr("groundtruth.txt:1:"), HasSubstr("'x'")));
}

TEST(TumSource, StampsOfTheGroundTruthMayBeNanoseconds) {
  const SequenceFolder sequence(2);
  sequence.folder.write("groundtruth.txt",
                        "1700000000000000000 1 2 3 0 0 0 1\n1700000000066667000 2 2 3 0 0 0 1\n");
  EXPECT_EQ(TumSource(sequence.path()).info().ground_truth[1].stamp_ns, 1'700'000'000'066'667'000);
}

/// A sequence of three frames with the middle one damaged.
class OneBadFrame : public testing::Test {
 protected:
  void expect_skipped(const std::string& file, const std::string& reason) {
    TumSource source(sequence_.path());
    EXPECT_THAT(indices(read_all(source)), ElementsAre(0, 2));
    ASSERT_THAT(source.skipped(), SizeIs(1));
    EXPECT_EQ(source.skipped().front().name, "1.png");
    EXPECT_THAT(source.skipped().front().reason, AllOf(HasSubstr(file), HasSubstr(reason)));
    EXPECT_EQ(source.info().frames, 3U);
  }

  SequenceFolder sequence_{3};
};

TEST_F(OneBadFrame, MissingColour) {
  std::filesystem::remove(sequence_.path() / "rgb/1.png");
  expect_skipped("rgb/1.png", "no such file");
}

TEST_F(OneBadFrame, MissingDepth) {
  std::filesystem::remove(sequence_.path() / "depth/1.png");
  expect_skipped("depth/1.png", "no such file");
}

TEST_F(OneBadFrame, ColourCutShort) {
  const std::string whole = encoded(make_color(1), ".png");
  sequence_.folder.write("rgb/1.png", whole.substr(0, whole.size() - 20));
  expect_skipped("rgb/1.png", "truncated");
}

TEST_F(OneBadFrame, JpegCutShort) {
  const std::string whole = encoded(make_color(1), ".jpg");
  sequence_.folder.write("rgb/1.png", whole.substr(0, whole.size() / 2));
  expect_skipped("rgb/1.png", "truncated");
}

TEST_F(OneBadFrame, DepthCutShort) {
  const std::string whole = encoded(make_depth(1001), ".png");
  sequence_.folder.write("depth/1.png", whole.substr(0, whole.size() / 2));
  expect_skipped("depth/1.png", "truncated");
}

TEST_F(OneBadFrame, NotAnImage) {
  sequence_.folder.write("rgb/1.png", "<html>404 not found</html>");
  expect_skipped("rgb/1.png", "neither a PNG nor a JPEG");
}

TEST_F(OneBadFrame, ColourOfAnotherSize) {
  sequence_.folder.write("rgb/1.png", encoded(make_color(1, CV_8UC3, {16, 12}), ".png"));
  expect_skipped("rgb/1.png", "16 x 12");
}

TEST_F(OneBadFrame, DepthOfAnotherSize) {
  sequence_.folder.write("depth/1.png", encoded(make_depth(1001, {16, 12}), ".png"));
  expect_skipped("depth/1.png", "16 x 12");
}

TEST_F(OneBadFrame, DepthOfEightBits) {
  sequence_.folder.write("depth/1.png", encoded(make_color(1, CV_8UC1), ".png"));
  expect_skipped("depth/1.png", "16-bit");
}

TEST_F(OneBadFrame, TheFirstOneIsNoDifferent) {
  sequence_.folder.write("rgb/0.png", encoded(make_color(1, CV_8UC3, {16, 12}), ".png"));
  TumSource source(sequence_.path());
  EXPECT_THAT(indices(read_all(source)), ElementsAre(1, 2));
  EXPECT_THAT(source.skipped(), SizeIs(1));
}

TEST(TumSourceTime, RowThatRepeatsATimeStampIsSkipped) {
  const SequenceFolder sequence(3);
  sequence.folder.write("rgb.txt", "100.0 rgb/0.png\n100.0 rgb/1.png\n100.066667 rgb/2.png\n");
  TumSource source(sequence.path());
  EXPECT_THAT(indices(read_all(source)), ElementsAre(0, 2));
  ASSERT_THAT(source.skipped(), SizeIs(1));
  EXPECT_EQ(source.skipped().front().name, "rgb/1.png");
  EXPECT_THAT(source.skipped().front().reason,
              AllOf(HasSubstr("rgb.txt:2:"), HasSubstr("repeats that of line 1")));
  EXPECT_EQ(source.info().frames, 3U);
}

TEST(TumSourceTime, RowThatGoesBackIsSkipped) {
  const SequenceFolder sequence(4);
  sequence.folder.write("associations.txt",
                        "# rows\n100.00 rgb/0.png 100.00 depth/0.png\n100.10 rgb/1.png 100.10 depth/1.png\n"
                        "100.05 rgb/2.png 100.05 depth/2.png\n100.15 rgb/3.png 100.15 depth/3.png\n");
  TumSource source(sequence.path());
  EXPECT_THAT(indices(read_all(source)), ElementsAre(0, 1, 3));
  ASSERT_THAT(source.skipped(), SizeIs(1));
  EXPECT_THAT(source.skipped().front().reason,
              AllOf(HasSubstr("associations.txt:4:"), HasSubstr("is earlier than"), HasSubstr("line 3")));
}

TEST(TumSourceTime, ListThatIsMostlyOutOfOrderIsAnError) {
  const SequenceFolder sequence(4);
  sequence.folder.write("rgb.txt", "103 rgb/3.png\n102 rgb/2.png\n101 rgb/1.png\n100 rgb/0.png\n");
  EXPECT_THAT(open_error(sequence.path()),
              AllOf(HasSubstr("rgb.txt:2:"), HasSubstr("3 of 4"), HasSubstr("sort")));
  sequence.folder.write("rgb.txt", "100 rgb/3.png\n100 rgb/2.png\n100 rgb/1.png\n");
  EXPECT_THAT(open_error(sequence.path()), AllOf(HasSubstr("rgb.txt:2:"), HasSubstr("do not increase")));
}

TEST(TumSourceErrors, FolderThatIsNotThereOrNotASequence) {
  const TempFolder folder;
  RgbdCamera camera = *camera_preset("freiburg1");
  const auto error = [&](const std::filesystem::path& path) {
    return input_error([&] { TumSource source(path, camera); });
  };
  EXPECT_THAT(error(folder.path() / "none"), AllOf(HasSubstr("none"), HasSubstr("no such folder")));
  EXPECT_THAT(error(folder.write("file", "x")), HasSubstr("not a folder"));
  EXPECT_THAT(error(folder.path()), AllOf(HasSubstr("no rgb.txt, depth.txt"), HasSubstr("known layout")));
  folder.write("rgb.txt", "1 a.png\n");
  EXPECT_THAT(error(folder.path()), HasSubstr("no depth.txt"));
  EXPECT_THAT(open_error(folder.path() / "none"), HasSubstr("no such folder"));
}

TEST(TumSourceErrors, ListsThatCannotBeUsed) {
  const SequenceFolder sequence(2);
  const auto error_with = [&](const char* name, const char* content) {
    sequence.folder.write(name, content);
    return open_error(sequence.path());
  };
  EXPECT_THAT(error_with("rgb.txt", ""), AllOf(HasSubstr("rgb.txt"), HasSubstr(": empty")));
  EXPECT_THAT(error_with("rgb.txt", "# only\n\n"), HasSubstr(": empty"));
  EXPECT_THAT(error_with("rgb.txt", "# t f\n100.0\n"), AllOf(HasSubstr("rgb.txt:2:"), HasSubstr("1 fields")));
  EXPECT_THAT(error_with("rgb.txt", "nan rgb/0.png\n"), AllOf(HasSubstr("rgb.txt:1:"), HasSubstr("'nan'")));
  EXPECT_THAT(error_with("rgb.txt", "500.0 rgb/0.png\n"), HasSubstr("within 0.02 s"));
  EXPECT_THAT(error_with("associations.txt", "100.0 rgb/0.png\n"), HasSubstr("associations.txt:1:"));
  EXPECT_THAT(error_with("associations.txt", "100.0 rgb/0.png inf depth/0.png\n"),
              AllOf(HasSubstr("associations.txt:1:"), HasSubstr("'inf' is not a timestamp")));
  EXPECT_THAT(error_with("associations.txt", ""), HasSubstr(": empty"));
}

TEST(TumSourceErrors, CameraOfAnotherSizeIsReportedAtOnce) {
  const SequenceFolder sequence(5);
  EXPECT_THAT(input_error([&] { TumSource source(sequence.path(), *camera_preset("freiburg1")); }),
              AllOf(HasSubstr("rgb/0.png: 32 x 24"), HasSubstr("640 x 480"), HasSubstr("--camera")));
}

TEST(TumSourceErrors, NotOneFrameIntact) {
  const SequenceFolder sequence(2);
  for (const char* name : {"depth/0.png", "depth/1.png"}) sequence.folder.write(name, "");
  TumSource source(sequence.path());
  EXPECT_THAT(input_error([&] { source.next(); }),
              AllOf(HasSubstr("none of the 2 frames"), HasSubstr("depth/0.png")));
}

TEST(TumSourceErrors, AssociationsWithDepthFirstAreExplained) {
  const SequenceFolder sequence(2);
  sequence.folder.write("associations.txt",
                        "100.0 depth/0.png 100.0 rgb/0.png\n100.1 depth/1.png 100.1 rgb/1.png\n");
  TumSource source(sequence.path());
  EXPECT_THAT(input_error([&] { source.next(); }), HasSubstr("colour comes first"));
}

TEST(TumSourceErrors, NoCameraSaysWhatToDo) {
  const SequenceFolder sequence(2);
  std::filesystem::remove(sequence.path() / "camera.yaml");
  EXPECT_THAT(open_error(sequence.path()), AllOf(HasSubstr("camera.yaml"), HasSubstr("--camera")));
}

}  // namespace
}  // namespace kinloop
