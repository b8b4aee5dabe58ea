#include "kinloop/place/place_index.hpp"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

BowVector random_bow(Random& random, uint32_t words, uint32_t size) {
  auto chosen = sample_without_replacement(random, words, size);
  std::sort(chosen.begin(), chosen.end());
  std::vector<double> weights;
  double sum = 0;
  for (size_t i = 0; i < chosen.size(); ++i) sum += weights.emplace_back(random.uniform(0.1, 1));
  BowVector bow;
  for (size_t i = 0; i < chosen.size(); ++i) {
    bow.emplace_back(WordId{chosen[i]}, static_cast<float>(weights[i] / sum));
  }
  return bow;
}

using Bows = std::map<KeyframeId, BowVector>;

std::vector<PlaceCandidate> brute_force(const Bows& bows, const BowVector& query, size_t max_results,
                                        const std::function<bool(KeyframeId)>& accept = {}) {
  std::vector<PlaceCandidate> candidates;
  for (const auto& [id, bow] : bows) {
    const double score = similarity(query, bow);
    if (score > 0 && (!accept || accept(id))) candidates.push_back({id, score});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  candidates.resize(std::min(max_results, candidates.size()));
  return candidates;
}

constexpr size_t kAll = 1'000'000;

TEST(PlaceIndex, GivesExactlyTheScoresOfBruteForce) {
  Random random(1);
  PlaceIndex index;
  Bows bows;
  for (uint32_t step = 0; step < 400; ++step) {
    if (!bows.empty() && random.uniform() < 0.3) {
      const auto removed = std::next(bows.begin(), random.index(static_cast<uint32_t>(bows.size())));
      index.remove(removed->first);
      bows.erase(removed);
    } else {
      const KeyframeId id{(step * 7919) % 1000};  // neither in order nor contiguous
      const BowVector bow = random_bow(random, 300, 1 + random.index(60));
      index.add(id, bow);
      bows.emplace(id, bow);
    }
    ASSERT_EQ(index.size(), bows.size());
    const BowVector query = random_bow(random, 320, 40);  // including unseen words
    ASSERT_EQ(index.query(query, kAll), brute_force(bows, query, kAll)) << "step " << step;
    ASSERT_EQ(index.query(query, 5), brute_force(bows, query, 5));
    const auto odd = [](KeyframeId id) { return id.value % 2 == 1; };
    ASSERT_EQ(index.query(query, 5, odd), brute_force(bows, query, 5, odd));
  }
  for (const auto& [id, bow] : bows) EXPECT_EQ(index.bow_of(id), bow);
}

TEST(PlaceIndex, FindsIndexedImages) {
  Random random(2);
  PlaceIndex index;
  for (uint32_t id = 0; id < 50; ++id) index.add({id}, random_bow(random, 500, 50));
  for (uint32_t id = 0; id < 50; ++id) {
    const auto found = index.query(index.bow_of({id}), 1);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].keyframe, KeyframeId{id});
    EXPECT_NEAR(found[0].score, 1, 1e-6);
  }
}

TEST(PlaceIndex, StopWordsDoNotHideSimilarImages) {
  // Ten words that all images have, and a few distinctive ones. With a limit of 150 postings the common ones
  // must be left out.
  Random random(3);
  PlaceIndex all, some(150);
  std::map<KeyframeId, BowVector> bows;
  for (uint32_t id = 0; id < 200; ++id) {
    BowVector bow;
    for (uint32_t word = 0; word < 10; ++word) bow.emplace_back(WordId{word}, 0.05F);
    for (uint32_t word = 0; word < 10; ++word) bow.emplace_back(WordId{10 + 10 * id + word}, 0.05F);
    all.add({id}, bow);
    some.add({id}, bow);
    bows.emplace(KeyframeId{id}, bow);
  }
  for (const auto& [id, bow] : bows) EXPECT_EQ(some.query(bow, 1), all.query(bow, 1)) << id.value;
  EXPECT_EQ(all.query(bows.at({7}), kAll).size(), 200U);
  EXPECT_EQ(some.query(bows.at({7}), kAll).size(), 1U);  // the others have only stop words in common
}

TEST(PlaceIndex, EqualScoresComeInTheOrderOfIds) {
  PlaceIndex index;
  const BowVector bow = {{WordId{3}, 1.0F}};
  for (const uint32_t id : {9U, 2U, 5U}) index.add({id}, bow);
  EXPECT_THAT(index.query(bow, kAll),
              ElementsAre(PlaceCandidate{{2}, 1}, PlaceCandidate{{5}, 1}, PlaceCandidate{{9}, 1}));
  EXPECT_THAT(index.query(bow, 2), ElementsAre(PlaceCandidate{{2}, 1}, PlaceCandidate{{5}, 1}));
}

TEST(PlaceIndex, NoCommonWordMeansNoCandidate) {
  PlaceIndex index;
  EXPECT_THAT(index.query({{WordId{3}, 1.0F}}, kAll), IsEmpty());
  index.add({1}, {{WordId{4}, 1.0F}});
  index.add({2}, {});  // an image without features
  EXPECT_THAT(index.query({{WordId{3}, 1.0F}}, kAll), IsEmpty());
  EXPECT_THAT(index.query({{WordId{99}, 1.0F}}, kAll), IsEmpty());
  EXPECT_THAT(index.query({}, kAll), IsEmpty());
  EXPECT_THAT(index.query({{WordId{4}, 1.0F}}, 0), IsEmpty());
  EXPECT_TRUE(index.bow_of({2}).empty());
}

TEST(PlaceIndex, RemovedKeyframesAreGone) {
  PlaceIndex index;
  const BowVector bow = {{WordId{0}, 0.5F}, {WordId{7}, 0.5F}};
  index.add({1}, bow);
  index.add({2}, bow);
  index.remove({1});
  EXPECT_FALSE(index.contains({1}));
  EXPECT_EQ(index.size(), 1U);
  EXPECT_THAT(index.query(bow, kAll), ElementsAre(PlaceCandidate{{2}, 1}));
  index.add({1}, bow);  // and may be added again
  EXPECT_EQ(index.query(bow, kAll).size(), 2U);
}

TEST(PlaceIndex, MisuseThrows) {
  PlaceIndex index;
  index.add({1}, {});
  EXPECT_THROW(index.add({1}, {}), std::logic_error);
  EXPECT_THROW(index.add({}, {}), std::logic_error);
  EXPECT_THROW(index.remove({2}), std::logic_error);
  EXPECT_THROW((void)index.bow_of({2}), std::logic_error);
}

}  // namespace
}  // namespace kinloop
