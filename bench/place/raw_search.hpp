#pragma once
// Recognition without a vocabulary: an image is the one that most descriptors of the query have their nearest
// in, among all descriptors of all images.

#include "bench/place/recognizers.hpp"

namespace kinloop {

/// All looked at, two threads.
Recognition by_brute_force(std::span<const Place> places);

/// By locality-sensitive hashing (FLANN).
Recognition by_lsh(std::span<const Place> places, uint64_t seed);

/// By randomised Kd trees over the bits as numbers 0 and 1 (FLANN): their squared distance is Hamming's.
Recognition by_kd_trees(std::span<const Place> places, uint64_t seed);

}  // namespace kinloop
