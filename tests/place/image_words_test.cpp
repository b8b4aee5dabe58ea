#include "bench/place/image_words.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "bench/place/place_search.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/random_vectors.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

constexpr double kTolerance_px = 3;

ImageWords random_image(Random& random, uint32_t points, uint32_t words) {
  ImageWords image;
  for (uint32_t i = 0; i < points; ++i) {
    const Eigen::Vector2f pixel = test::uniform_vector<2>(random, {0, 0}, {640, 480}).cast<float>();
    image.push_back(
        {{random.index(words)}, random.next(), pixel, static_cast<float>(random.uniform(0, 6)), 1});
  }
  std::stable_sort(image.begin(), image.end(), [](auto& a, auto& b) { return a.word < b.word; });
  return image;
}

/// The image rotated, scaled and translated, with some signature bits flipped.
ImageWords moved(ImageWords image, double turn_rad, double scale, Random& random) {
  const double c = scale * std::cos(turn_rad), s = scale * std::sin(turn_rad);
  for (QuantizedKeypoint& point : image) {
    const Eigen::Vector2d p = point.pixel.cast<double>();
    point.pixel = Eigen::Vector2d(c * p.x() - s * p.y() + 30, s * p.x() + c * p.y() - 12).cast<float>();
    point.angle_rad += static_cast<float>(turn_rad);
    point.scale *= static_cast<float>(scale);
    point.signature ^= uint64_t{1} << random.index(64);
  }
  return image;
}

TEST(ImageWords, AShiftedImageMatchesCompletely) {
  Random random(1);
  const ImageWords image = random_image(random, 100, 5000);
  for (const double turn_rad : {0.0, 0.4, -2.0}) {
    const ImageWords other = moved(image, turn_rad, 1.3, random);
    const auto matches = match_words(image, other, 4);
    EXPECT_EQ(matches.size(), image.size());
    EXPECT_EQ(geometric_support(image, other, matches, kTolerance_px), image.size());
  }
}

TEST(ImageWords, SameWordsAtOtherPixelsDoNotSupportEachOther) {
  Random random(2);
  const ImageWords image = random_image(random, 100, 5000);
  ImageWords scattered = moved(image, 0, 1, random);
  for (QuantizedKeypoint& point : scattered) {
    point.pixel = test::uniform_vector<2>(random, {0, 0}, {640, 480}).cast<float>();
  }
  const auto matches = match_words(image, scattered, 4);
  EXPECT_EQ(matches.size(), image.size());
  EXPECT_LE(geometric_support(image, scattered, matches, kTolerance_px), 5U);
  EXPECT_EQ(geometric_support(image, scattered, {}, kTolerance_px), 0U);
}

TEST(ImageWords, OtherSignaturesDoNotMatch) {
  Random random(3);
  const ImageWords a = random_image(random, 200, 10), b = random_image(random, 200, 10);
  EXPECT_GT(match_words(a, b, 64).size(), 150U);
  EXPECT_LT(match_words(a, b, 10).size(), 5U);  // 20 each of random bits: a distance of 32 of 64 on average
}

TEST(MatchWithinNodes, IsBruteForceWithinEachNode) {
  Random random(4);
  const auto a = test::clustered_descriptors(120, 40, 0.1, 5),
             b = test::clustered_descriptors(100, 40, 0.1, 5);
  std::vector<NodeId> nodes_a, nodes_b;
  for (size_t i = 0; i < a.size(); ++i) nodes_a.push_back({random.index(6)});
  for (size_t i = 0; i < b.size(); ++i) nodes_b.push_back({1 + random.index(6)});
  const auto nearest = [](auto& from, auto& nodes_from, size_t i, auto& to, auto& nodes_to) {
    size_t best = to.size();
    for (size_t j = 0; j < to.size(); ++j) {
      if (nodes_from[i] != nodes_to[j]) continue;
      if (best == to.size() || test::distance(from[i], to[j]) < test::distance(from[i], to[best])) best = j;
    }
    return best;
  };
  std::vector<Match> expected;
  for (size_t i = 0; i < a.size(); ++i) {
    const size_t j = nearest(a, nodes_a, i, b, nodes_b);
    if (j == b.size() || nearest(b, nodes_b, j, a, nodes_a) != i) continue;
    expected.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>(j), test::distance(a[i], b[j])});
  }
  EXPECT_GT(expected.size(), 20U);
  EXPECT_EQ(match_within_nodes(test::to_mat(a), nodes_a, test::to_mat(b), nodes_b), expected);
}

TEST(PlaceSearch, PrefersConsistentGeometryToSharedWords) {
  // Keyframe 1 has all words of the query in other places; keyframe 2 has half of them in the right places.
  Random random(6);
  const ImageWords query = random_image(random, 80, 100'000);
  const auto bow_of = [](const ImageWords& image) {
    BowVector bow;
    for (const QuantizedKeypoint& point : image)
      bow.emplace_back(point.word, 1.0F / static_cast<float>(image.size()));
    return bow;
  };
  ImageWords scattered = query;
  for (QuantizedKeypoint& point : scattered) point.pixel = {static_cast<float>(random.uniform(0, 640)), 5};
  ImageWords half = moved(query, 0.2, 1, random);
  half.resize(40);
  PlaceSearch search;
  search.add({1}, bow_of(scattered), scattered);
  search.add({2}, bow_of(half), half);
  EXPECT_EQ(search.index().query(bow_of(query), 2).front().keyframe, KeyframeId{1});
  const auto found = search.query(bow_of(query), query, 2);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0], (PlaceCandidate{{2}, 40}));
  search.remove({2});
  EXPECT_EQ(search.query(bow_of(query), query, 2).front().keyframe, KeyframeId{1});
}

}  // namespace
}  // namespace kinloop
