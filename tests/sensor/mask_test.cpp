#include "kinloop/sensor/surfaces/mask.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace kinloop {
namespace {

TEST(Mask, TheIntersectionUsesWhatBothUse) {
  const cv::Mat a = (cv::Mat_<uint8_t>(1, 4) << 0, 0, 255, 255), b = (cv::Mat_<uint8_t>(1, 4) << 0, 1, 0, 1);
  const cv::Mat both = intersection_of_masks(a, b);
  for (int x = 0; x < 4; ++x)
    EXPECT_EQ(both.at<uint8_t>(x) != 0, a.at<uint8_t>(x) != 0 && b.at<uint8_t>(x) != 0) << x;
}

TEST(Mask, APixelKeepsAllItsCauses) {
  const cv::Mat a = (cv::Mat_<uint8_t>(1, 3) << 0, 0, 255), b = (cv::Mat_<uint8_t>(1, 3) << 0, 9, 0);
  const cv::Mat causes = with_cause(with_cause({}, a, IgnoreCause::kUser), b, IgnoreCause::kMoved);
  EXPECT_EQ(causes.at<uint8_t>(0),
            static_cast<uint8_t>(IgnoreCause::kUser) | static_cast<uint8_t>(IgnoreCause::kMoved));
  EXPECT_EQ(causes.at<uint8_t>(1), static_cast<uint8_t>(IgnoreCause::kUser));
  EXPECT_EQ(causes.at<uint8_t>(2), static_cast<uint8_t>(IgnoreCause::kMoved));
  const cv::Mat used = used_pixels(with_cause({}, a, IgnoreCause::kUser));
  for (int x = 0; x < 3; ++x) EXPECT_EQ(used.at<uint8_t>(x), a.at<uint8_t>(x)) << x;
  EXPECT_TRUE(used_pixels({}).empty());
}

TEST(Mask, AnEmptyOneUsesAll) {
  const cv::Mat a = (cv::Mat_<uint8_t>(1, 2) << 0, 255);
  EXPECT_EQ(intersection_of_masks(a, {}).data, a.data);
  EXPECT_EQ(intersection_of_masks({}, a).data, a.data);
  EXPECT_TRUE(intersection_of_masks({}, {}).empty());
}

}  // namespace
}  // namespace kinloop
