#include "drivers/image_files/fast_encoder.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "drivers/image_files/image_file.hpp"

namespace kinloop {
namespace {

TEST(FastEncoder, IsReadBackByOpenCvToTheBit) {
  cv::RNG random(4);
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(640, 480)}) {
      cv::Mat wide(size.height, size.width + 5, type);
      random.fill(wide, cv::RNG::UNIFORM, 0, 70000);
      const cv::Mat image = wide.colRange(2, size.width + 2);  // noncontiguous rows
      const std::string bytes = encode_png(image);
      EXPECT_EQ(image_damage(bytes), "");
      const std::vector<uint8_t> file(bytes.begin(), bytes.end());
      const cv::Mat read = cv::imdecode(file, cv::IMREAD_UNCHANGED);
      ASSERT_EQ(read.type(), type);
      ASSERT_EQ(read.size(), size);
      EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0) << type << " " << size;
    }
  }
}

TEST(FastEncoder, MakesFlatImagesSmall) {
  EXPECT_LT(encode_png(cv::Mat(480, 640, CV_16UC1, cv::Scalar(7))).size(), 10'000U);
}

TEST(FastEncoder, RejectsUnsupportedImages) {
  EXPECT_THROW(encode_png({}), std::logic_error);
  EXPECT_THROW(encode_png(cv::Mat(2, 2, CV_32FC1, cv::Scalar(1))), std::logic_error);
}

}  // namespace
}  // namespace kinloop
