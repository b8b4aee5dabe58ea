#include "kinloop/features/matcher.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "kinloop/features/hamming.hpp"
#include "tests/support/random_vectors.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using test::make_world;

cv::Mat random_descriptors(int rows, uint64_t seed) {
  return make_world(static_cast<uint32_t>(rows), seed).descriptors;
}

int slow_distance(const cv::Mat& a, int i, const cv::Mat& b, int j) {
  int distance = 0;
  for (int byte = 0; byte < kOrbBytes; ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      distance += ((a.at<uint8_t>(i, byte) ^ b.at<uint8_t>(j, byte)) >> bit) & 1;
    }
  }
  return distance;
}

TEST(Hamming, CountsDifferentBits) {
  const cv::Mat a = random_descriptors(20, 1), b = random_descriptors(20, 2);
  for (int i = 0; i < a.rows; ++i) {
    EXPECT_EQ(hamming_distance(a.ptr<uint8_t>(i), b.ptr<uint8_t>(i)), slow_distance(a, i, b, i));
    EXPECT_EQ(hamming_distance(a.ptr<uint8_t>(i), a.ptr<uint8_t>(i)), 0);
  }
}

TEST(BruteForce, FindsTheNearestOfAll) {
  const cv::Mat a = random_descriptors(60, 3), b = random_descriptors(80, 4);
  const auto matches = match_brute_force(a, b, false);
  ASSERT_EQ(matches.size(), 60U);
  for (const Match& match : matches) {
    EXPECT_EQ(match.distance, slow_distance(a, static_cast<int>(match.a), b, static_cast<int>(match.b)));
    for (int j = 0; j < b.rows; ++j)
      EXPECT_LE(match.distance, slow_distance(a, static_cast<int>(match.a), b, j));
  }
}

TEST(BruteForce, CrossCheckIsSymmetric) {
  const cv::Mat a = random_descriptors(70, 5), b = random_descriptors(50, 6);
  auto forth = match_brute_force(a, b, true);
  auto back = match_brute_force(b, a, true);
  for (Match& match : back) std::swap(match.a, match.b);
  std::sort(back.begin(), back.end());
  EXPECT_EQ(forth, back);
  EXPECT_LT(forth.size(), 50U);
}

TEST(BruteForce, NothingMatchesNothing) {
  EXPECT_TRUE(match_brute_force(cv::Mat(), random_descriptors(3, 1), false).empty());
  EXPECT_TRUE(match_brute_force(random_descriptors(3, 1), cv::Mat(), true).empty());
}

TEST(Screen, KeepsUpToFourTimesTheSmallest) {
  const std::vector<Match> matches{{0, 0, 15}, {1, 1, 60}, {2, 2, 61}};
  const auto kept = filter_matches_by_distance(matches, 4.0, 0);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[1].distance, 60);
}

TEST(Screen, APerfectMatchDoesNotRejectAllOthers) {
  const std::vector<Match> matches{{0, 0, 0}, {1, 1, 30}, {2, 2, 41}};
  EXPECT_EQ(filter_matches_by_distance(matches, 4.0, 40).size(), 2U);
  EXPECT_TRUE(filter_matches_by_distance({}, 4.0, 40).empty());
}

TEST(FeatureGrid, FindsWhatAScanFinds) {
  const auto world = make_world(3000, 7);
  const auto view = test::observe(world, SE3{}, {}, 8);
  const FeatureGrid grid(*view.features, world.camera.width, world.camera.height);
  std::vector<uint32_t> found;
  Random random(9);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector2d pixel = test::uniform_vector<2>(random, {-30, -30}, {670, 510});
    const double radius = random.uniform(1, 60);
    std::vector<uint32_t> expected;
    for (uint32_t i = 0; i < view.features->size(); ++i) {
      if ((view.features->pixels[i].cast<double>() - pixel).cwiseAbs().maxCoeff() <= radius)
        expected.push_back(i);
    }
    grid.features_in_area(pixel, radius, found);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

TEST(FeatureGrid, PositionsThatAreNoNumbersAreAtTheBorder) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Features features;
  features.pixels = {{std::numeric_limits<float>::quiet_NaN(), -kInfinity}, {1e6F, 1e30F}, {5, 5}};
  const FeatureGrid grid(features, 640, 480);
  std::vector<uint32_t> found;
  grid.features_in_area({5, 5}, 2, found);
  EXPECT_EQ(found, std::vector<uint32_t>{2});
  grid.features_in_area({5, 5}, 1e300, found);
  EXPECT_EQ(found, (std::vector<uint32_t>{2, 1}));
}

TEST(ProjectionMatching, FindsThePointsBehindTheKeypoints) {
  const auto world = make_world(2000, 10);
  const auto view = test::observe(world, SE3{}, {}, 11);
  std::vector<ProjectedPoint> projected;
  for (const uint32_t point : view.point_of) {
    projected.push_back({world.camera.project(world.p_world[point]), 5, world.p_world[point].z(), 0, 1,
                         world.descriptors.ptr<uint8_t>(static_cast<int>(point))});
  }
  const FeatureGrid grid(*view.features, world.camera.width, world.camera.height);
  const auto matches = match_by_projection(projected, *view.features, grid, {});
  EXPECT_GT(matches.size(), view.point_of.size() * 95 / 100);
  std::vector<int> uses(view.features->size(), 0);
  for (const Match& match : matches) {
    EXPECT_EQ(match.a, match.b);  // the view lists the points in keypoint order
    EXPECT_EQ(++uses[match.b], 1);
  }
}

TEST(ProjectionMatching, RejectsAnotherDepthOrLevel) {
  const auto world = make_world(500, 12);
  const auto view = test::observe(world, SE3{}, {0.0, 0.0, 0, 0.0}, 13);
  const uint32_t point = view.point_of[0];
  const FeatureGrid grid(*view.features, world.camera.width, world.camera.height);
  ProjectedPoint expected{world.camera.project(world.p_world[point]),
                          3,
                          world.p_world[point].z(),
                          0,
                          1,
                          world.descriptors.ptr<uint8_t>(static_cast<int>(point))};
  const auto matches_of = [&] {
    return match_by_projection(std::span(&expected, 1), *view.features, grid, {}).size();
  };
  EXPECT_EQ(matches_of(), 1U);
  expected.depth_m *= 2;
  EXPECT_EQ(matches_of(), 0U);
  expected.depth_m /= 2;
  expected.level_low = expected.level_high = 3;
  EXPECT_EQ(matches_of(), 0U);
}

}  // namespace
}  // namespace kinloop
