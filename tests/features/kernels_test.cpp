// The kernels compared with plain code, on every instruction set of the machine.

#include <set>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/features/kernels/corner_scores.hpp"
#include "kinloop/features/kernels/gaussian_blur.hpp"
#include "kinloop/features/kernels/hamming_rows.hpp"
#include "kinloop/features/kernels/steered_brief.hpp"
#include "tests/features/cluttered_image.hpp"
#include "tests/support/simd_targets.hpp"

namespace kinloop {
namespace {

using test::cluttered_image;
using test::for_each_simd_target;

/// By definition: the worst pixel of the best arc.
int slow_contrast(const cv::Mat& image, int x, int y) {
  constexpr int kCircle[16][2] = {{0, 3},  {1, 3},   {2, 2},   {3, 1},   {3, 0},  {3, -1}, {2, -2}, {1, -3},
                                  {0, -3}, {-1, -3}, {-2, -2}, {-3, -1}, {-3, 0}, {-3, 1}, {-2, 2}, {-1, 3}};
  int best = 0;
  for (int start = 0; start < 16; ++start) {
    int brighter = 255, darker = 255;
    for (int i = 0; i < 9; ++i) {
      const int* step = kCircle[(start + i) % 16];
      const int difference = image.at<uint8_t>(y + step[1], x + step[0]) - image.at<uint8_t>(y, x);
      brighter = std::min(brighter, difference);
      darker = std::min(darker, -difference);
    }
    best = std::max({best, brighter, darker});
  }
  return best;
}

cv::Mat random_image(int width, int height, uint64_t seed) {
  cv::Mat image(height, width, CV_8UC1);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<uint8_t>(y, x) = static_cast<uint8_t>(random.index(256));
  }
  return image;
}

TEST(FindCorners, FindsTheStrongestOfTheirNeighboursOnly) {
  constexpr int kThreshold = 12, kBorder = 5;
  const cv::Mat image = cluttered_image(11)(cv::Rect(100, 100, 131, 90)).clone();
  std::set<std::pair<int, int>> expected;
  const auto contrast = [&](int x, int y) {
    const bool inside = x >= kBorder && y >= kBorder && x < image.cols - kBorder && y < image.rows - kBorder;
    const int value = inside ? slow_contrast(image, x, y) : 0;
    return value > kThreshold ? value : 0;
  };
  for (int y = kBorder; y < image.rows - kBorder; ++y) {
    for (int x = kBorder; x < image.cols - kBorder; ++x) {
      const int here = contrast(x, y);
      bool strongest = here > 0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u) {
          const bool before = v < 0 || (v == 0 && u < 0);
          if (u == 0 && v == 0) continue;
          strongest = strongest && (before ? here > contrast(x + u, y + v) : here >= contrast(x + u, y + v));
        }
      }
      if (strongest) expected.insert({x, y});
    }
  }
  ASSERT_GT(expected.size(), 50U);
  for_each_simd_target([&](const std::string& name) {
    std::set<std::pair<int, int>> found;
    for (const RawCorner& corner : find_corners(image, kThreshold, kBorder)) {
      found.insert({corner.x, corner.y});
      EXPECT_EQ(corner.contrast, slow_contrast(image, corner.x, corner.y)) << name;
      EXPECT_LE(std::abs(corner.dx), 0.5F) << name;
      EXPECT_LE(std::abs(corner.dy), 0.5F) << name;
    }
    EXPECT_EQ(found, expected) << name;
  });
}

TEST(FindCorners, FindsWhatOpenCvFinds) {
  const cv::Mat image = cluttered_image(12);
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image, corners, 20, true);
  std::set<std::pair<int, int>> found;
  for (const RawCorner& corner : find_corners(image, 20, 3)) found.insert({corner.x, corner.y});
  // OpenCV drops both of two equal neighbours, kinloop the second.
  for (const auto& corner : corners) {
    EXPECT_TRUE(found.contains({cvRound(corner.pt.x), cvRound(corner.pt.y)}));
  }
  EXPECT_LT(found.size(), corners.size() * 5 / 4);
}

TEST(FindCorners, SmallImagesHaveNone) {
  EXPECT_TRUE(find_corners(random_image(30, 30, 1), 5, 3).empty());
  EXPECT_TRUE(find_corners(random_image(200, 6, 1), 5, 3).empty());
}

TEST(GaussianBlur, IsTheGaussianOfOpenCv) {
  const cv::Mat big = random_image(150, 120, 2);
  const cv::Mat image = big(cv::Rect(10, 10, 101, 60));
  cv::Mat exact, weights = cv::getGaussianKernel(7, 2, CV_64F);
  big.convertTo(exact, CV_64F);
  cv::sepFilter2D(exact, exact, CV_64F, weights, weights);
  for_each_simd_target([&](const std::string& name) {
    const cv::Mat blurred = gaussian_blur(image);
    for (int y = kBlurRadius; y < image.rows - kBlurRadius; ++y) {
      for (int x = kBlurRadius; x < image.cols - kBlurRadius; ++x) {
        ASSERT_EQ(blurred.at<uint8_t>(y, x), cvRound(exact.at<double>(y + 10, x + 10))) << name;
      }
    }
    EXPECT_EQ(blurred.at<uint8_t>(0, 50), image.at<uint8_t>(0, 50));
  });
}

TEST(Orientation, MomentsAreThoseOfTheDisc) {
  const cv::Mat image = random_image(80, 80, 3);
  DiscMoments expected;
  for (int v = -kDiscRadius; v <= kDiscRadius; ++v) {
    const auto half = static_cast<int>(std::lround(std::sqrt(kDiscRadius * kDiscRadius - v * v)));
    for (int u = -half; u <= half; ++u) {
      expected.m10 += u * image.at<uint8_t>(37 + v, 41 + u);
      expected.m01 += v * image.at<uint8_t>(37 + v, 41 + u);
    }
  }
  for_each_simd_target(
      [&](const std::string& name) { EXPECT_EQ(disc_moments(image, 41, 37), expected) << name; });
}

TEST(Orientation, PointsToTheBrightSide) {
  cv::Mat image(64, 64, CV_8UC1, cv::Scalar(255));
  image.rowRange(0, 32).setTo(0);
  EXPECT_NEAR(orientation_deg(image, 32, 32), 90, 1);
  EXPECT_NEAR(orientation_deg(image.t(), 32, 32), 0, 1);
}

/// For the same keypoints, every bit must equal cv::ORB's.
TEST(SteeredBrief, DescribesAsOpenCvDoes) {
  for (const uint64_t seed : {21, 22, 23}) {
    const cv::Mat image = cluttered_image(seed);
    Random random(seed);
    std::vector<cv::KeyPoint> points;
    for (int i = 0; i < 400; ++i) {
      const auto turn_deg = static_cast<float>(random.uniform(0, 360));
      const auto y = static_cast<float>(40 + random.index(400));
      points.emplace_back(static_cast<float>(40 + random.index(560)), y, 31.0F, turn_deg, 1.0F, 0);
    }
    cv::Mat expected;
    cv::ORB::create(1000, 1.2F, 1)->compute(image, points, expected);
    ASSERT_EQ(points.size(), 400U);
    for_each_simd_target([&](const std::string& name) {
      const cv::Mat blurred = gaussian_blur(image);
      cv::Mat ours(expected.size(), CV_8UC1);
      for (int i = 0; i < ours.rows; ++i) {
        const auto& point = points[static_cast<size_t>(i)];
        describe_corner(blurred, cvRound(point.pt.x), cvRound(point.pt.y), point.angle, ours.ptr<uint8_t>(i));
      }
      EXPECT_EQ(cv::norm(ours, expected, cv::NORM_HAMMING), 0) << name;
    });
  }
}

TEST(HammingRows, AreTheDistancesOnEveryInstructionSet) {
  for (const int count : {1, 63, 64, 200}) {
    cv::Mat rows = random_image(kOrbBytes, count, 5);
    const cv::Mat query = random_image(kOrbBytes, 1, 6);
    const cv::Mat opposite = ~query;
    opposite.copyTo(rows.row(0));  // the largest distance: 256 does not fit a byte
    std::vector<uint32_t> indices;
    for (int i = count; i-- > 0;) indices.push_back(static_cast<uint32_t>(i));
    for_each_simd_target([&](const std::string& name) {
      const TransposedDescriptors turned(rows.ptr<uint8_t>(), static_cast<size_t>(count));
      std::vector<uint16_t> all(turned.padded_count()), some(indices.size());
      turned.distances_from(query.ptr<uint8_t>(), all);
      hamming_to_rows(query.ptr<uint8_t>(), rows.ptr<uint8_t>(), indices, some.data());
      for (int i = 0; i < count; ++i) {
        const int expected = hamming_distance(query.ptr<uint8_t>(), rows.ptr<uint8_t>(i));
        EXPECT_EQ(all[static_cast<size_t>(i)], expected) << name;
        EXPECT_EQ(some[static_cast<size_t>(count - 1 - i)], expected) << name;
      }
      for (auto i = static_cast<size_t>(count); i < all.size(); ++i)
        EXPECT_EQ(all[i], kInvalidDistance) << name;
      EXPECT_EQ(all[0], 256) << name;
    });
  }
}

TEST(NearestKey, TiesGoToTheLowerIndexOnEveryInstructionSet) {
  std::vector<uint16_t> distances(64, 100);
  distances[7] = distances[40] = 30;
  for_each_simd_target([&](const std::string& name) {
    std::vector<uint32_t> keys(64, kNoKey);
    const uint32_t best = nearest_key(distances, 3, keys.data());
    EXPECT_EQ(index_of_key(best), 7U) << name;
    EXPECT_EQ(distance_of_key(best), 30) << name;
    nearest_key(distances, 5, keys.data());  // equal distance, larger index: no effect
    for (const uint32_t key : keys) EXPECT_EQ(index_of_key(key), 3U) << name;
  });
}

TEST(Extractor, GivesTheSameBitsOnEveryInstructionSet) {
  const cv::Mat image = cluttered_image(31);
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 525;
  const Features expected = extract_features(image, cv::Mat(), Sensor{camera}, {});
  for_each_simd_target([&](const std::string& name) {
    const Features found = extract_features(image, cv::Mat(), Sensor{camera}, {});
    EXPECT_EQ(found.pixels, expected.pixels) << name;
    EXPECT_EQ(found.angles_rad, expected.angles_rad) << name;
    EXPECT_EQ(found.levels, expected.levels) << name;
    ASSERT_EQ(found.descriptors.size(), expected.descriptors.size()) << name;
    EXPECT_EQ(cv::norm(found.descriptors, expected.descriptors, cv::NORM_HAMMING), 0) << name;
  });
}

}  // namespace
}  // namespace kinloop
