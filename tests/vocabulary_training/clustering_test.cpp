#include "tools/vocabulary_training/clustering/clustering.hpp"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>

#include "tests/place/synthetic.hpp"
#include "tools/vocabulary_training/clustering/distributed_points.hpp"

namespace kinloop {
namespace {

using test::clustered_descriptors;
using test::distance;
using test::random_descriptor;

BinaryDescriptor majority_centre(const std::vector<BinaryDescriptor>& points,
                                 const BinaryDescriptor& current) {
  std::vector<uint64_t> counts(HammingSpace::kCounts, 0);
  for (const auto& point : points) HammingSpace::add(point, counts.data());
  return HammingSpace::mean(counts.data(), points.size(), current);
}

std::vector<BinaryDescriptor> seed_points(const std::vector<BinaryDescriptor>& points,
                                          const ClusterOptions& options) {
  const Communicator alone;
  return seed_centres(DistributedPoints<HammingSpace>(points, options, alone), options);
}

Clusters<HammingSpace> cluster_binary(const std::vector<BinaryDescriptor>& points,
                                      const ClusterOptions& options) {
  return cluster<HammingSpace>(points, options);
}

uint64_t distance_sum(const std::vector<BinaryDescriptor>& points, const BinaryDescriptor& centre) {
  uint64_t sum = 0;
  for (const auto& point : points) sum += static_cast<uint64_t>(distance(point, centre));
  return sum;
}

TEST(MajorityCentre, NoFlipOfAnyBitLowersTheSumOfDistances) {
  // The sum is a sum over bits, so a centre that no single flip improves is the best of all 2^256.
  for (const int count : {1, 2, 3, 10, 17}) {
    const auto points = clustered_descriptors(count, 1, 0.3, 7);
    const BinaryDescriptor centre = majority_centre(points, points.front());
    const uint64_t best = distance_sum(points, centre);
    for (size_t bit = 0; bit < 8 * centre.size(); ++bit) {
      BinaryDescriptor flipped = centre;
      flipped[bit / 8] = static_cast<uint8_t>(flipped[bit / 8] ^ (1U << (bit % 8)));
      ASSERT_GE(distance_sum(points, flipped), best) << count << " points, bit " << bit;
    }
  }
}

TEST(MajorityCentre, TiesKeepTheCurrentCentre) {
  Random random(3);
  const BinaryDescriptor a = random_descriptor(random), b = random_descriptor(random);
  EXPECT_EQ(majority_centre(std::vector{a, b}, a), a);
  EXPECT_EQ(majority_centre(std::vector{a, b}, b), b);
}

class SeedCentres : public testing::TestWithParam<Seeding> {};

TEST_P(SeedCentres, AreDistinctPointsOfTheInput) {
  const auto points = clustered_descriptors(300, 20, 0.1, 11);
  const auto centres = seed_points(points, {.clusters = 20, .seeding = GetParam(), .seed = 5});
  ASSERT_EQ(centres.size(), 20U);
  EXPECT_EQ(std::set(centres.begin(), centres.end()).size(), centres.size());
  for (const auto& centre : centres) EXPECT_THAT(points, testing::Contains(centre));
}

TEST_P(SeedCentres, DependOnTheSeedAndNothingElse) {
  const auto points = clustered_descriptors(5000, 20, 0.1, 12);
  const auto seeds = [&](uint64_t seed, int threads) {
    return seed_points(points, {.clusters = 8, .seeding = GetParam(), .seed = seed, .threads = threads});
  };
  EXPECT_EQ(seeds(1, 1), seeds(1, 3));
  EXPECT_NE(seeds(1, 1), seeds(2, 1));
}

INSTANTIATE_TEST_SUITE_P(Seedings, SeedCentres,
                         testing::Values(Seeding::kRandom, Seeding::kKmeansPlusPlus,
                                         Seeding::kKmeansParallel));

TEST(SeedCentres, KmeansPlusPlusDrawsProportionallyToTheHammingDistance) {
  // The first centre is one of three points, the second another one of them. From a, b (10 bits away) and c
  // (30 bits away) must be drawn as 1 : 3; squared distances would give 1 : 9.
  BinaryDescriptor a{}, b{}, c{};
  for (size_t bit = 0; bit < 10; ++bit) b[bit / 8] = static_cast<uint8_t>(b[bit / 8] | (1U << (bit % 8)));
  for (size_t bit = 100; bit < 130; ++bit) c[bit / 8] = static_cast<uint8_t>(c[bit / 8] | (1U << (bit % 8)));
  const std::vector points = {a, b, c};
  double drawn_b = 0, drawn_c = 0;
  for (uint64_t seed = 0; seed < 6000; ++seed) {
    const auto centres = seed_points(points, {.clusters = 2, .seed = seed, .candidates = 1});
    ASSERT_EQ(centres.size(), 2U);
    if (centres[0] != a) continue;
    (centres[1] == b ? drawn_b : drawn_c) += 1;
  }
  EXPECT_NEAR(drawn_c / (drawn_b + drawn_c), 0.75, 0.04);  // 2000 draws: deviation 0.01
}

uint64_t median_distance_sum(const std::vector<BinaryDescriptor>& points, Seeding seeding, int candidates,
                             int iterations) {
  std::vector<uint64_t> sums;
  for (uint64_t seed = 1; seed <= 9; ++seed) {
    sums.push_back(cluster_binary(points, {.clusters = 40,
                                           .seeding = seeding,
                                           .iterations = iterations,
                                           .seed = seed,
                                           .candidates = candidates})
                       .distance_sum);
  }
  std::nth_element(sums.begin(), sums.begin() + 4, sums.end());
  return sums[4];
}

TEST(Clustering, KmeansPlusPlusFindsClustersThatRandomSeedsMiss) {
  const auto points = clustered_descriptors(2000, 40, 0.05, 21);
  for (const int iterations : {0, 20}) {
    const auto random = median_distance_sum(points, Seeding::kRandom, 0, iterations);
    const auto plain = median_distance_sum(points, Seeding::kKmeansPlusPlus, 1, iterations);
    const auto greedy = median_distance_sum(points, Seeding::kKmeansPlusPlus, 0, iterations);
    const auto parallel = median_distance_sum(points, Seeding::kKmeansParallel, 0, iterations);
    EXPECT_LT(parallel, random) << iterations << " iterations";
    EXPECT_LT(plain, random) << iterations << " iterations";
    EXPECT_LE(greedy, plain) << iterations << " iterations";
  }
}

TEST(Clustering, EveryPointIsWithItsNearestCentre) {
  const auto points = clustered_descriptors(1500, 30, 0.2, 31);
  const auto clusters = cluster_binary(points, {.clusters = 12, .iterations = 3});
  uint64_t sum = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto nearest =
        std::min_element(clusters.centres.begin(), clusters.centres.end(),
                         [&](auto& a, auto& b) { return distance(a, points[i]) < distance(b, points[i]); });
    ASSERT_EQ(clusters.cluster_of[i], static_cast<uint32_t>(nearest - clusters.centres.begin()));
    sum += static_cast<uint64_t>(distance(*nearest, points[i]));
  }
  EXPECT_EQ(clusters.distance_sum, sum);
}

TEST(Clustering, MoreIterationsNeverRaiseTheSumOfDistances) {
  const auto points = clustered_descriptors(1500, 60, 0.2, 32);
  uint64_t previous = std::numeric_limits<uint64_t>::max();
  for (const int iterations : {0, 1, 2, 3, 5, 10, 100}) {
    const auto clusters =
        cluster_binary(points, {.clusters = 15, .seeding = Seeding::kRandom, .iterations = iterations});
    EXPECT_LE(clusters.distance_sum, previous);
    previous = clusters.distance_sum;
  }
}

TEST(Clustering, NoClusterIsEmptyAmongManyDuplicates) {
  // 1000 copies of one point and 5 others: random seeds fall on the copies, and only refilling empty clusters
  // can find the others.
  Random random(4);
  std::vector<BinaryDescriptor> points(1000, random_descriptor(random));
  for (int i = 0; i < 5; ++i) points.push_back(random_descriptor(random));
  for (const auto seeding : {Seeding::kRandom, Seeding::kKmeansPlusPlus, Seeding::kKmeansParallel}) {
    const auto clusters = cluster_binary(points, {.clusters = 6, .seeding = seeding, .iterations = 20});
    EXPECT_EQ(clusters.centres.size(), 6U);
    EXPECT_EQ(clusters.distance_sum, 0U);
    EXPECT_EQ(std::set(clusters.cluster_of.begin(), clusters.cluster_of.end()).size(),
              clusters.centres.size());
  }
}

TEST(Clustering, FewerDifferentPointsThanClustersGiveThatMany) {
  Random random(5);
  const BinaryDescriptor a = random_descriptor(random), b = random_descriptor(random);
  for (const auto seeding : {Seeding::kRandom, Seeding::kKmeansPlusPlus, Seeding::kKmeansParallel}) {
    EXPECT_THAT(cluster_binary(std::vector{a, b, a, a}, {.clusters = 10, .seeding = seeding}).centres,
                testing::UnorderedElementsAre(a, b));
    EXPECT_THAT(cluster_binary(std::vector{a}, {.clusters = 10, .seeding = seeding}).centres,
                testing::ElementsAre(a));
  }
}

TEST(Clustering, DoesNotDependOnTheNumberOfThreads) {
  const auto points = clustered_descriptors(4001, 50, 0.2, 41);
  const auto one = cluster_binary(points, {.clusters = 10, .threads = 1});
  for (const int threads : {2, 3, 7}) {
    const auto many = cluster_binary(points, {.clusters = 10, .threads = threads});
    EXPECT_EQ(many.centres, one.centres);
    EXPECT_EQ(many.cluster_of, one.cluster_of);
  }
}

}  // namespace
}  // namespace kinloop
