// Small files that claim huge images: their size is compared with that of the camera before anything is
// decoded. The images here are also damaged, so that decoding them first would give another message.

#include <gmock/gmock.h>

#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/openni2/openni_image.hpp"
#include "drivers/ros/bag_source.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "drivers/stream/frame_protocol.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/images/image_limits.hpp"
#include "tests/drivers/bag_writers.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::HasSubstr;

constexpr const char* kClaim = "6000 x 8000 pixels where";

/// The width and height of a PNG are at bytes 16 and 20, those of a JPEG behind its start of frame.
std::string claiming(std::string image) {
  const std::string png_size("\0\0\x17\x70\0\0\x1F\x40", 8), jpeg_size("\x1F\x40\x17\x70", 4);
  const bool png = image.starts_with("\x89PNG");
  const std::string& size = png ? png_size : jpeg_size;
  return image.replace(png ? 16 : image.find("\xff\xc0") + 5, size.size(), size);
}

std::string color_png() {
  return claiming(test::encoded(test::make_color(1), ".png"));
}

std::string color_jpeg() {
  return claiming(test::encoded(test::make_color(1), ".jpg"));
}

std::string depth_png() {
  return claiming(test::encoded(test::make_depth(1000), ".png"));
}

std::vector<uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

TEST(ImageBomb, InAFolderIsSkipped) {
  const test::SequenceFolder sequence(5);
  sequence.folder.write(test::SequenceFolder::color_name(1), color_png());
  sequence.folder.write(test::SequenceFolder::color_name(2), color_jpeg());
  sequence.folder.write(test::SequenceFolder::depth_name(3), depth_png());
  const auto source = open_sequence(sequence.path().string());
  while (source->next()) {
  }
  ASSERT_EQ(source->skipped().size(), 3U);
  for (const SkippedFrame& skipped : source->skipped()) EXPECT_THAT(skipped.reason, HasSubstr(kClaim));
}

TEST(ImageBomb, InABagIsSkipped) {
  constexpr auto kKind = test::Serialization::kCdrLittle;
  PinholeCamera lens;
  lens.width = test::kWidth, lens.height = test::kHeight;
  lens.fx = lens.fy = 25, lens.cx = 15.5, lens.cy = 11.5;
  const std::string type = "sensor_msgs/msg/CompressedImage", depth_header(12, '\0');
  const std::string rvl_size("\x70\x17\0\0\x40\x1F\0\0", 8);
  const auto depth = [&](const char* format, const std::string& data) {
    return test::WrittenMessage{"/camera/aligned_depth_to_color/image_raw/compressedDepth", type, 2,
                                test::compressed_message(kKind, 2, format, depth_header + data)};
  };
  const test::WrittenBag bag = {
      {"/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", 1, test::info_message(kKind, lens)},
      {"/camera/color/image_raw/compressed", type, 1,
       test::compressed_message(kKind, 1, "jpeg", color_jpeg())},
      depth("16UC1; compressedDepth png", depth_png()),
      depth("16UC1; compressedDepth rvl", rvl_size + "damaged")};
  const test::TempFolder folder;
  const auto source = open_bag(folder.write("a.mcap", test::mcap_bytes(bag, {})), {});
  EXPECT_THAT(input_error([&] { source->next(); }), HasSubstr(kClaim));
  ASSERT_EQ(source->skipped().size(), 3U);
  for (const SkippedFrame& skipped : source->skipped()) EXPECT_THAT(skipped.reason, HasSubstr(kClaim));
}

TEST(ImageBomb, InAStreamIsAnError) {
  PinholeCamera camera;
  camera.width = test::kWidth, camera.height = test::kHeight;
  for (const std::string& image : {color_png(), color_jpeg()})
    EXPECT_THAT(input_error([&] {
                  decode_sent_color({"jpeg", bytes_of(image)}, camera);
                }),
                HasSubstr(kClaim));
  EXPECT_THAT(input_error([&] {
                decode_sent_depth({"png", bytes_of(depth_png())}, camera, 1000);
              }),
              HasSubstr(kClaim));
}

TEST(ImageBomb, OfOpenNiIsAnError) {
  const std::string jpeg = color_jpeg();
  const OpenNiImage image{test::kWidth, test::kHeight, 0, OpenNiPixels::kJpeg, false, as_bytes(jpeg)};
  EXPECT_THAT(input_error([&] { color_from(image); }), HasSubstr(kClaim));
}

TEST(ImageBomb, AFileLargerThanAnyImageIsNotRead) {
  const test::TempFolder folder;
  const auto path = folder.write("huge.png", "\x89PNG");
  std::filesystem::resize_file(path, kMaxEncodedBytes + 1);  // without blocks on the disk
  EXPECT_THAT(input_error([&] { read_bytes({path}); }), HasSubstr("at most"));
  EXPECT_THAT(input_error([&] { read_bytes({path, 1, kMaxEncodedBytes + 1}); }), HasSubstr("at most"));
}

}  // namespace
}  // namespace kinloop
