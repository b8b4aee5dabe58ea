#include "drivers/openni2/oni_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "drivers/openni2/oni_file.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/oni_writer.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

constexpr uint32_t kDepthNode = 1, kColorNode = 2;
constexpr uint64_t kPeriod_us = 33'333, kDepthDelay_us = 5'000;

struct OniParts {
  test::OniWriterStream depth;
  test::OniWriterStream color{kColorNode, 3, "NONE", 200};
  uint32_t frames = 3;
};

cv::Mat depth_image(uint32_t frame) {
  cv::Mat depth = test::make_depth(static_cast<uint16_t>(1000 + frame));
  depth.at<uint16_t>(2, 3) = 0;
  depth.at<uint16_t>(2, 4) = 4321;
  return depth;
}

std::string bytes_of(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

std::string color_bytes(uint32_t frame, const OniParts& parts) {
  const cv::Mat color = test::make_color(static_cast<int>(frame));
  if (parts.color.codec == "JPEG") return test::encoded(color, ".jpg");
  cv::Mat rgb = color.clone();
  for (int i = 0; i < rgb.rows * rgb.cols; ++i) std::swap(rgb.ptr()[3 * i], rgb.ptr()[3 * i + 2]);
  return bytes_of(rgb);
}

std::string oni_bytes(const OniParts& parts) {
  std::string bytes = test::oni_header() + test::oni_stream(parts.depth, parts.frames) +
                      test::oni_stream(parts.color, parts.frames) +
                      test::oni_data_begin(kDepthNode, parts.frames) +
                      test::oni_data_begin(kColorNode, parts.frames);
  for (uint32_t i = 0; i < parts.frames; ++i) {
    const uint64_t stamp_us = kPeriod_us * (i + 1);
    bytes += test::oni_image(kColorNode, stamp_us, i + 1, color_bytes(i, parts));
    bytes += test::oni_image(kDepthNode, stamp_us + kDepthDelay_us, i + 1, bytes_of(depth_image(i)));
  }
  return bytes + test::oni_end();
}

/// Returns the same recording in format 1.0.0.5, whose positions have 32 bits.
std::string in_older_format(const std::string& bytes) {
  std::string older = "NI10" + test::raw(uint8_t{1}) + test::raw(uint8_t{0}) + test::raw(uint16_t{0}) +
                      test::raw(uint32_t{5}) + bytes.substr(12, 12);
  ByteReader records(as_bytes(bytes).subspan(24));
  while (records.left() > 0) {
    records.number<uint32_t>();
    auto type = records.number<uint32_t>();
    const auto node = records.number<uint32_t>(), size = records.number<uint32_t>() - 28,
               payload = records.number<uint32_t>();
    records.number<uint64_t>();
    std::string fields(as_text(records.block(size)));
    if (type == 0x0D) type = 0x0C, fields.resize(fields.size() - 8);  // no seek table
    older += test::raw(uint32_t{0x0052494E}) + test::raw(type) + test::raw(node) +
             test::raw(static_cast<uint32_t>(24 + fields.size())) + test::raw(payload) +
             test::raw(uint32_t{0}) + fields + std::string(as_text(records.block(payload)));
  }
  return older;
}

class OniRecordingTest : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const std::string& bytes,
                                    const std::optional<RgbdCamera>& camera = {}) const {
    return open_oni_recording(folder.write("a.oni", bytes), camera);
  }
  const test::TempFolder folder;
};

double largest_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

TEST_F(OniRecordingTest, GivesTheFramesWithBothStamps) {
  const auto source = open(oni_bytes({}));
  EXPECT_EQ(source->info().frames, 3U);
  EXPECT_EQ(source->camera().fps, 30);
  EXPECT_NEAR(source->camera().color.fx, 16 / std::tan(0.5 * test::kOniView_rad), 1e-9);
  EXPECT_NEAR(source->camera().color.fy, 12 / std::tan(0.375 * test::kOniView_rad), 1e-9);
  EXPECT_EQ(source->camera().color.cx, 15.5);
  for (uint32_t i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp_ns, static_cast<int64_t>(1000 * kPeriod_us * (i + 1)));
    EXPECT_EQ(frame->depth_stamp_ns, frame->stamp_ns + static_cast<int64_t>(1000 * kDepthDelay_us));
    EXPECT_EQ(largest_difference(frame->color.bgr(), test::make_color(static_cast<int>(i))), 0);
    cv::Mat expected_m;
    depth_image(i).convertTo(expected_m, CV_32FC1, 1e-3);
    EXPECT_LT(largest_difference(frame->depth_m, expected_m), 1e-6);
  }
  EXPECT_FALSE(source->next());
  EXPECT_THAT(source->skipped(), SizeIs(0));
}

TEST_F(OniRecordingTest, MirroredImagesAreUnmirrored) {
  OniParts parts;
  const auto plain = open(oni_bytes(parts))->next();
  parts.color.mirrored = parts.depth.mirrored = true;
  const auto mirrored = open(oni_bytes(parts))->next();
  ASSERT_TRUE(plain && mirrored);
  cv::Mat color, depth_m;
  cv::flip(plain->color.bgr(), color, 1);
  cv::flip(plain->depth_m, depth_m, 1);
  EXPECT_EQ(largest_difference(mirrored->color.bgr(), color), 0);
  EXPECT_EQ(largest_difference(mirrored->depth_m, depth_m), 0);
}

TEST_F(OniRecordingTest, ReadsTheOlderFormat) {
  const auto newer = open(oni_bytes({}))->next(), older = open(in_older_format(oni_bytes({})))->next();
  ASSERT_TRUE(newer && older);
  EXPECT_EQ(older->stamp_ns, newer->stamp_ns);
  EXPECT_EQ(largest_difference(older->color.bgr(), newer->color.bgr()), 0);
  EXPECT_EQ(largest_difference(older->depth_m, newer->depth_m), 0);
}

TEST_F(OniRecordingTest, ReadsJpegAndDepthInTenthsOfMillimetres) {
  OniParts parts;
  parts.color.codec = "JPEG";
  parts.depth.pixels = 101;
  const auto frame = open(oni_bytes(parts))->next();
  ASSERT_TRUE(frame);
  const std::string jpeg = color_bytes(0, parts);
  EXPECT_EQ(
      largest_difference(frame->color.bgr(),
                         cv::imdecode(std::vector<uint8_t>(jpeg.begin(), jpeg.end()), cv::IMREAD_COLOR)),
      0);
  EXPECT_NEAR(frame->depth_m.at<float>(2, 4), 0.4321, 1e-6);
}

TEST_F(OniRecordingTest, NamesFileAndRemedy) {
  EXPECT_THAT(input_error([&] { open_oni_recording("absent.oni", {}); }), HasSubstr("absent.oni"));
  for (const char* wrong : {"", "NI10", "this is text and not a recording"})
    EXPECT_THAT(input_error([&] { open(wrong); }), AllOf(HasSubstr("a.oni"), HasSubstr("record it again")));
  EXPECT_THAT(input_error([&] { open(test::oni_header() + test::oni_end()); }),
              HasSubstr("record colour and depth"));
  std::string newer = oni_bytes({});
  newer[4] = 2;
  EXPECT_THAT(input_error([&] { open(newer); }), HasSubstr("version 2.0.1.0"));
  OniParts parts;
  parts.color.view_rad = 0;
  EXPECT_THAT(input_error([&] { open(oni_bytes(parts)); }), AllOf(HasSubstr("a.oni"), HasSubstr("--camera")));
  parts = {};
  parts.depth.size = {16, 12};
  EXPECT_THAT(input_error([&] { open(oni_bytes(parts)); }), HasSubstr("16 x 12"));
  parts = {};
  parts.color.size = parts.depth.size = {1 << 20, 1 << 20};
  EXPECT_THAT(input_error([&] { open(oni_bytes(parts)); }), HasSubstr("not possible"));
  parts = {};
  parts.depth.codec = "abcd";
  EXPECT_THAT(input_error([&] { open(oni_bytes(parts))->next(); }), HasSubstr("abcd"));
}

TEST_F(OniRecordingTest, ATruncatedFileGivesItsFirstFrames) {
  const std::string whole = oni_bytes({});
  size_t before = 0;
  for (size_t size = 0; size < whole.size(); size += 97) {
    size_t frames = 0;
    try {
      const auto source = open(whole.substr(0, size));
      while (source->next()) ++frames;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("a.oni"));
    }
    EXPECT_GE(frames, before);
    before = frames;
    std::filesystem::remove(folder.path() / "a.oni");
  }
  EXPECT_GE(before, 2U);
  const auto unfinished = open(whole.substr(0, whole.size() - test::oni_end().size()));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(unfinished->next());
  EXPECT_FALSE(unfinished->next());
  EXPECT_THAT(unfinished->skipped(), SizeIs(0));
}

TEST_F(OniRecordingTest, ADamagedImageIsSkippedAndCounted) {
  OniParts parts;
  parts.depth.codec = "16zT";  // the images are not
  parts.frames = 1;
  EXPECT_THAT(input_error([&] { open(oni_bytes(parts))->next(); }), HasSubstr("no usable frame"));
  std::string bytes = oni_bytes({});
  const size_t middle = bytes.find(bytes_of(depth_image(1)));
  bytes[middle - 12 + 7] = '\x7F';  // its stamp
  const auto source = open(bytes);
  ASSERT_TRUE(source->next());
  const auto last = source->next();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->stamp_ns, static_cast<int64_t>(3000 * kPeriod_us));
  EXPECT_FALSE(source->next());
  EXPECT_THAT(source->skipped(), SizeIs(2)) << "the image, and colour without a partner";
}

TEST_F(OniRecordingTest, NoMutatedFileBreaksTheReader) {
  OniParts parts;
  parts.frames = 1;
  parts.color.codec = "JPEG";
  const std::string bytes = oni_bytes(parts);
  Random random(22);
  for (int i = test::mutations(2000); i > 0; --i) {
    const auto path = folder.write("m.oni", test::mutated(bytes, random));
    try {
      const auto source = open_oni_recording(path, {});
      while (source->next()) {
      }
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), testing::Not(HasSubstr("\n")));
    }
    std::filesystem::remove(path);
  }
}

TEST(Decode16z, DecodesEveryCode) {
  const auto values = [](std::vector<uint8_t> bytes, int pixels, bool with_table) {
    const cv::Mat depth = decode_16z(bytes, {pixels, 1}, with_table);
    return std::vector<uint16_t>(depth.begin<uint16_t>(), depth.end<uint16_t>());
  };
  // 1000; two differences; a difference and a full value; a difference of a byte; two repetitions; a last
  // one.
  EXPECT_EQ(values({0xE8, 0x03, 0x57, 0x6F, 0x10, 0x01, 0xFF, 0xC0 + 40, 0xE1, 0x5D}, 9, false),
            (std::vector<uint16_t>{1000, 1001, 1000, 1000, 0x1001, 0x1001 - 40, 0x1001 - 40, 0x1001 - 40,
                                   0x1001 - 39}));
  EXPECT_EQ(values({2, 0, 0, 0, 0xE8, 0x03, 0, 0, 0x57}, 3, true), (std::vector<uint16_t>{0, 1000, 0}));
  const auto error = [&](std::vector<uint8_t> bytes, bool with_table) {
    return input_error([&] { decode_16z(bytes, {3, 1}, with_table); });
  };
  EXPECT_THAT(error({0xE8, 0x03, 0x5D}, false), HasSubstr("2 of 3"));
  EXPECT_THAT(error({0xE8, 0x03, 0xE3}, false), HasSubstr("too many"));
  EXPECT_THAT(error({0xE8, 0x03, 0xFF, 0x10}, false), HasSubstr("truncated"));
  EXPECT_THAT(error({1, 0, 0, 0, 0, 0, 0x57}, true), HasSubstr("beyond its table"));
}

}  // namespace
}  // namespace kinloop
