#include "kinloop/place/match_by_nodes.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

cv::Mat random_descriptors(int count, uint64_t seed) {
  cv::Mat descriptors(count, kOrbBytes, CV_8UC1);
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    for (int b = 0; b < kOrbBytes; ++b) descriptors.at<uint8_t>(i, b) = static_cast<uint8_t>(random.next());
  }
  return descriptors;
}

/// The rows in reverse order, with the first bits of each flipped.
cv::Mat reversed(const cv::Mat& descriptors, uint8_t flips) {
  cv::Mat rows;
  cv::flip(descriptors, rows, 0);
  for (int i = 0; i < rows.rows; ++i) rows.at<uint8_t>(i, 0) ^= flips;
  return rows;
}

TEST(MatchByNodes, EqualsBruteForceIfAllShareANode) {
  const cv::Mat a = random_descriptors(60, 1), b = reversed(a, 0x0f);
  const std::vector<NodeId> nodes(60, NodeId{3});
  const auto matches = match_by_nodes({a, nodes}, {b, nodes}, {});
  EXPECT_EQ(matches, match_brute_force(a, b, true));
  EXPECT_EQ(matches.size(), 60U);
}

TEST(MatchByNodes, OnlyCommonNodesAreCompared) {
  const cv::Mat a = random_descriptors(4, 1);
  const std::vector<NodeId> nodes_a{NodeId{5}, NodeId{2}, NodeId{9}, NodeId{2}};
  const std::vector<NodeId> nodes_b{NodeId{2}, NodeId{2}, NodeId{7}, NodeId{5}};  // of rows 3, 2, 1, 0 of `a`
  const auto matches = match_by_nodes({a, nodes_a}, {reversed(a, 0), nodes_b}, {});
  const std::vector<Match> expected{{0, 3, 0}, {3, 0, 0}};
  EXPECT_EQ(matches, expected);
}

TEST(MatchByNodes, DistantAndAmbiguousMatchesAreDropped) {
  const cv::Mat a = random_descriptors(2, 1);
  const std::vector<NodeId> nodes(2, NodeId{0});
  EXPECT_TRUE(match_by_nodes({a, nodes}, {reversed(a, 0x0f), nodes}, {.max_distance = 3}).empty());
  cv::Mat twins;
  cv::vconcat(a.row(0), a.row(0), twins);
  EXPECT_TRUE(match_by_nodes({a, nodes}, {twins, nodes}, {}).empty()) << "two equally near";
}

TEST(MatchByNodes, NothingToMatch) {
  const cv::Mat a = random_descriptors(3, 1);
  const std::vector<NodeId> nodes(3, NodeId{0});
  EXPECT_TRUE(match_by_nodes({a, nodes}, {cv::Mat(), {}}, {}).empty());
  EXPECT_TRUE(match_by_nodes({cv::Mat(), {}}, {a, nodes}, {}).empty());
}

}  // namespace
}  // namespace kinloop
