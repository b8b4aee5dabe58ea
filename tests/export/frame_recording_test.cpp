#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/tum_writer.hpp"
#include "drivers/recording_format.hpp"
#include "drivers/ros/bag_source.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/export/mcap/recording.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::HasSubstr;

constexpr int kWidth = 48, kHeight = 36;
constexpr int64_t kStart_ns = 1'305'031'910'765'238'001;

RgbdCamera camera() {
  RgbdCamera camera;
  camera.color = {kWidth, kHeight, 40.125, 41, 23.5, 17.25, {}};
  camera.color.lens.k1 = 0.1;
  camera.fps = 29.5;
  camera.rolling_shutter_s = 0.01;
  camera.sensor.set_by_source(DepthSensorModel::kAzureKinect);
  return camera;
}

/// Every second colour image is a JPEG; the stamps of depth wander.
Frame frame(int i) {
  Random random(static_cast<uint64_t>(i) + 1);
  cv::Mat color(kHeight, kWidth, CV_8UC3), depth_m(kHeight, kWidth, CV_32FC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      color.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<uint8_t>(5 * x + random.index(20)));
      // Unknown, and too far for 16 bits, in places.
      depth_m.at<float>(y, x) =
          x % 7 == 0 ? 0 : 0.4F * static_cast<float>(x) + 0.0113F * static_cast<float>(y * i);
    }
  }
  Frame frame;
  frame.stamp_ns = kStart_ns + int64_t{i} * 33'333'333;
  frame.depth_stamp_ns = frame.stamp_ns + (i - 3) * 9'000'001;
  frame.depth_m = depth_m;
  frame.color = color;
  if (i % 2 == 1) {
    const auto jpeg = encode_jpeg(color, 90);
    frame.color = *ColorImage::from_jpeg({jpeg.begin(), jpeg.end()});
  }
  return frame;
}

constexpr int kFrames = 7;

std::string record(const std::filesystem::path& path) {
  FrameRecording recording(path, camera());
  for (int i = 0; i < kFrames; ++i) recording.write(compress_frame(frame(i), camera().depth_scale));
  recording.commit();
  return path.string();
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(FrameRecording, OfTwoWithOneNameTheSecondIsKeptBesideTheFirst) {
  const test::TempFolder folder;
  const auto path = folder.path() / "a.mcap";
  {
    FrameRecording second(path, camera());
    second.write(compress_frame(frame(3), camera().depth_scale));
    record(path);
    const std::string first = read_file(path);
    EXPECT_THAT(input_error([&] { second.commit(); }), HasSubstr("a.mcap: another process has written it"));
    EXPECT_TRUE(read_file(path) == first);
  }
  std::vector<std::string> recovered;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("recovered-") && name.ends_with(".mcap")) recovered.push_back(entry.path().string());
  }
  ASSERT_EQ(recovered.size(), 1U);
  EXPECT_TRUE(open_bag(recovered.front(), {}, {})->next());
}

TEST(FrameRecording, GivesTheFramesOfAFolderRecordedFromTheSame) {
  const test::TempFolder folder;
  TumWriter writer(folder.path() / "tum", camera());
  for (int i = 0; i < kFrames; ++i) writer.append(frame(i));
  writer.finish();
  const auto files = open_sequence((folder.path() / "tum").string(), {});
  const auto recording = open_bag(record(folder.path() / "a.mcap"), {});
  EXPECT_EQ(recording->info().frames, static_cast<size_t>(kFrames));
  EXPECT_EQ(recording->camera().color, camera().color);
  EXPECT_EQ(recording->camera().fps, camera().fps);
  EXPECT_EQ(recording->camera().rolling_shutter_s, camera().rolling_shutter_s);
  EXPECT_EQ(recording->camera().sensor.model, DepthSensorModel::kAzureKinect);
  for (int i = 0; i < kFrames; ++i) {
    const auto a = files->next(), b = recording->next();
    ASSERT_TRUE(a && b) << i;
    EXPECT_EQ(b->id, a->id);
    EXPECT_EQ(b->stamp_ns, frame(i).stamp_ns);
    EXPECT_EQ(b->stamp_ns, a->stamp_ns);
    EXPECT_EQ(b->depth_stamp_ns, frame(i).depth_stamp_ns) << "even if it is nearer to another colour image";
    EXPECT_EQ(b->depth_stamp_ns, a->depth_stamp_ns);
    EXPECT_TRUE(same(a->depth_m, b->depth_m)) << i;
    EXPECT_TRUE(same(a->color.gray(), b->color.gray())) << i;
    EXPECT_TRUE(same(a->color.bgr(), b->color.bgr())) << i;
    EXPECT_EQ(a->color.jpeg(), frame(i).color.jpeg()) << "the camera's own bytes";
    EXPECT_EQ(b->color.jpeg(), frame(i).color.jpeg());
  }
  EXPECT_FALSE(recording->next());
  EXPECT_TRUE(recording->skipped().empty());
}

TEST(FrameRecording, AFrameBeforeZeroKeepsItsStamp) {
  const test::TempFolder folder;
  Frame early = frame(0);
  early.stamp_ns = -1'250'000'000;
  early.depth_stamp_ns = -1'240'000'001;
  FrameRecording writer(folder.path() / "a.mcap", camera());
  writer.write(compress_frame(early, camera().depth_scale));
  writer.commit();
  const auto read = open_bag(folder.path() / "a.mcap", {})->next();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stamp_ns, early.stamp_ns);
  EXPECT_EQ(read->depth_stamp_ns, early.depth_stamp_ns);
}

TEST(FrameRecording, AnotherCameraKeepsTheUnitOfDepth) {
  const test::TempFolder folder;
  RgbdCamera other = camera();
  other.color.fx = 50;
  other.depth_scale = 1000;
  const auto recording = open_bag(record(folder.path() / "a.mcap"), other);
  EXPECT_EQ(recording->camera().color.fx, 50);
  EXPECT_FLOAT_EQ(recording->next()->depth_m.at<float>(0, 1), 0.4F);
  other.color.width = 640;
  EXPECT_THAT(input_error([&] { open_bag(folder.path() / "a.mcap", other)->next(); }), HasSubstr("640 x 36"));
}

TEST(FrameRecording, ATruncatedFileGivesItsFirstFrames) {
  const test::TempFolder folder;
  std::string bytes = read_file(record(folder.path() / "a.mcap"));
  bytes.resize(bytes.size() / 2);
  const auto cut = open_bag(folder.write("cut.mcap", bytes), {});
  int frames = 0;
  while (cut->next()) ++frames;
  EXPECT_GE(frames, kFrames / 2 - 1);
  EXPECT_LE(frames, kFrames / 2);
}

TEST(FrameRecording, NoMutatedFileBreaksTheReader) {
  const test::TempFolder folder;
  const std::string seed = read_file(record(folder.path() / "a.mcap"));
  Random random(5);
  for (int i = test::mutations(500); i > 0; --i)
    test::read_all(folder.write("m.mcap", test::mutated(seed, random)));
}

}  // namespace
}  // namespace kinloop
