#pragma once
// Hamming distances of one 256-bit descriptor to many.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

constexpr uint16_t kInvalidDistance = 257;  ///< larger than any distance between two descriptors

/// Distance and index packed into one key; the smallest key is the nearest, and on ties the first.
constexpr int kIndexBits = 22;
constexpr uint32_t kNoKey = uint32_t{kInvalidDistance} << kIndexBits;
constexpr uint32_t index_of_key(uint32_t key) {
  return key & ((1U << kIndexBits) - 1);
}
constexpr int distance_of_key(uint32_t key) {
  return static_cast<int>(key >> kIndexBits);
}

/// Computes the distances from `query` (32 bytes) to the rows of `rows` (32 bytes each) listed in `indices`.
void hamming_to_rows(const uint8_t* query, const uint8_t* rows, std::span<const uint32_t> indices,
                     uint16_t* distances);

/// Returns the smallest of the keys (distances[j], j), and lowers each of `keys` (one per distance) to
/// (distances[j], index) if that is smaller. The number of distances must be a multiple of 64.
uint32_t nearest_key(std::span<const uint16_t> distances, uint32_t index, uint32_t* keys);

/// Transposed descriptors: all first bytes, then all second bytes, and so on, so that a vector holds the same
/// byte of many descriptors. Built once for the many queries of a brute-force search.
class TransposedDescriptors {
 public:
  TransposedDescriptors(const uint8_t* rows, size_t count);

  [[nodiscard]] size_t count() const { return count_; }

  /// Number of distances that `distances_from` writes: count() rounded up to a multiple of 64.
  [[nodiscard]] size_t padded_count() const { return stride_; }

  /// Computes the distances from `query` to all descriptors; entries past count() are kInvalidDistance.
  void distances_from(const uint8_t* query, std::span<uint16_t> distances) const;

 private:
  size_t count_;
  size_t stride_;
  std::vector<uint8_t> bytes_;
};

}  // namespace kinloop
