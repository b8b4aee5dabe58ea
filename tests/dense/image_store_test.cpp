#include "dense/image_store.hpp"

#include <filesystem>
#include <limits>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

constexpr double kScale = 5000;

RgbdImages some_images(uint64_t seed) {
  Random random(seed);
  RgbdImages images{cv::Mat(48, 64, CV_8UC3), cv::Mat(48, 64, CV_32FC1)};
  for (int row = 0; row < 48; ++row) {
    for (int col = 0; col < 64; ++col) {
      images.color.at<cv::Vec3b>(row, col) = {static_cast<uint8_t>(2 * col), static_cast<uint8_t>(4 * row),
                                              90};
      const auto units = random.uniform() < 0.2 ? 0U : 1 + random.index(65534);
      images.depth_m.at<float>(row, col) = static_cast<float>(units / kScale);
    }
  }
  return images;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(ImageStore, DepthComesBackBitByBitAndColourNearly) {
  ImageStore store({.depth_scale = kScale});
  for (uint64_t i = 0; i < 3; ++i) {
    const auto images = some_images(i);
    EXPECT_EQ(store.add(images), i);
  }
  for (uint64_t i = 0; i < 3; ++i) {
    const auto original = some_images(i), kept = store.load(i);
    EXPECT_TRUE(same(kept.depth_m, original.depth_m));
    EXPECT_LT(cv::norm(kept.color, original.color, cv::NORM_L1) / static_cast<double>(original.color.total()),
              6);
  }
  EXPECT_EQ(store.bytes_on_disk(), 0U);
}

TEST(ImageStore, EncodingTellsWhatDecodingWillGive) {
  const ImageEncoding options{.depth_scale = kScale};
  const auto stored = encode_images(some_images(7).color, some_images(7).depth_m, options);
  const auto decoded = decode_images(stored.encoded, options);
  EXPECT_TRUE(same(stored.decoded.color, decoded.color));
  EXPECT_TRUE(same(stored.decoded.depth_m, decoded.depth_m));
}

TEST(ImageStore, AJpegIsKeptAsItCame) {
  const ImageEncoding options{.depth_scale = kScale, .jpeg_quality = 95};
  const auto images = some_images(8);
  const auto bytes = encode_images(images.color, images.depth_m, {.jpeg_quality = 60}).encoded.color;
  const auto came = ColorImage::from_jpeg({bytes.begin(), bytes.end()});
  ASSERT_TRUE(came.has_value());
  const auto stored = encode_images(*came, images.depth_m, options);
  EXPECT_EQ(stored.encoded.color, bytes);
  EXPECT_TRUE(same(stored.decoded.color, came->bgr()));
}

TEST(ImageStore, BeyondTheLimitTheyGoToDiskAndComeBackTheSame) {
  ImageStore in_memory({.depth_scale = kScale});
  ImageStore half({.depth_scale = kScale}, 20000);
  ImageStore on_disk({.depth_scale = kScale}, 0);
  for (uint64_t i = 0; i < 5; ++i) {
    const auto images = some_images(i);
    for (auto* store : {&in_memory, &half, &on_disk}) store->add(images);
  }
  EXPECT_EQ(on_disk.bytes_in_memory(), 0U);
  EXPECT_EQ(on_disk.bytes_on_disk(), in_memory.bytes_in_memory());
  EXPECT_LE(half.bytes_in_memory(), 20000U);
  EXPECT_GT(half.bytes_in_memory(), 0U);
  for (size_t i = 0; i < 5; ++i) {
    for (const auto* store : {&half, &on_disk}) {
      EXPECT_TRUE(same(store->load(i).color, in_memory.load(i).color));
      EXPECT_TRUE(same(store->load(i).depth_m, in_memory.load(i).depth_m));
    }
  }
}

TEST(ImageStore, DepthThatUnitsCannotHoldIsUnknown) {
  auto images = some_images(1);
  auto* depths = images.depth_m.ptr<float>();
  depths[0] = std::numeric_limits<float>::quiet_NaN();
  depths[1] = std::numeric_limits<float>::infinity();
  depths[2] = -1;
  depths[3] = 20;
  depths[4] = 1.00009F;
  ImageStore store({.depth_scale = kScale});
  store.add(images);
  const cv::Mat kept = store.load(0).depth_m;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(kept.ptr<float>()[i], 0) << i;
  EXPECT_EQ(kept.ptr<float>()[4], 1.0F);
}

TEST(ImageStore, MissingTempFolderIsReported) {
  const auto images = some_images(1);
  ImageStore store({}, 0);
  const test::EnvironmentVariable elsewhere("TMPDIR", "/proc/no-such-folder");
  EXPECT_THAT(test::input_error([&] { store.add(images); }), HasSubstr("set TMPDIR to another folder"));
}

}  // namespace
}  // namespace kinloop
