#pragma once
// Place recognition without a vocabulary: the answer is the image with most nearest neighbours of the query's
// descriptors, among all descriptors of all images.

#include "bench/place/recognizers.hpp"

namespace kinloop {

/// Exhaustive search on two threads.
Recognition by_brute_force(std::span<const Place> places);

/// Locality-sensitive hashing (FLANN).
Recognition by_lsh(std::span<const Place> places, uint64_t seed);

/// Randomised Kd trees over the bits as numbers 0 and 1 (FLANN): their squared distance is the Hamming
/// distance.
Recognition by_kd_trees(std::span<const Place> places, uint64_t seed);

}  // namespace kinloop
