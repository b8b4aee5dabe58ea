#pragma once
// In: the bags of words of keyframes. Out: the keyframes most similar to a query.

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "kinloop/core/ids.hpp"
#include "kinloop/place/bow_vector.hpp"

namespace kinloop {

/// A keyframe that may show the same place, with its similarity (0 to 1).
struct PlaceCandidate {
  KeyframeId keyframe;
  double score = 0;

  bool operator==(const PlaceCandidate&) const = default;
};

/// Inverted index: for each word, the keyframes that contain it (Sivic and Zisserman 2003). A query visits
/// only keyframes with a common word and returns exactly the scores of `similarity`.
/// If the words of a query have more than `max_postings` entries in total, its most frequent words are
/// treated as stop words: the words with the shortest lists select the candidates, several times as many as
/// requested, and only these are scored. This bounds the time of a query.
class PlaceIndex {
 public:
  /// Far more than a single run reaches; up to this limit a query is exhaustive.
  static constexpr size_t kMaxPostings = 400'000;

  explicit PlaceIndex(size_t max_postings = kMaxPostings) : max_postings_(max_postings) {}

  /// `keyframe` must not be in the index.
  void add(KeyframeId keyframe, BowVector bow);

  /// Removes a culled keyframe; it must be in the index.
  void remove(KeyframeId keyframe);

  /// Returns the best `max_results` keyframes with a score above 0 among those that `accept` admits (all by
  /// default), best first, ties by id.
  [[nodiscard]] std::vector<PlaceCandidate> query(const BowVector& bow, size_t max_results,
                                                  const std::function<bool(KeyframeId)>& accept = {}) const;

  [[nodiscard]] bool contains(KeyframeId keyframe) const { return slot_of_.contains(keyframe); }

  /// Returns the bag of words that `keyframe` was added with; it must be in the index.
  [[nodiscard]] const BowVector& bow_of(KeyframeId keyframe) const;

  [[nodiscard]] size_t size() const { return slot_of_.size(); }

 private:
  struct Entry {
    KeyframeId keyframe;  ///< invalid for a free slot
    BowVector bow;
  };
  struct Posting {
    uint32_t slot;
    float weight;
  };

  [[nodiscard]] uint32_t slot_of(KeyframeId keyframe) const;
  [[nodiscard]] BowVector without_stop_words(const BowVector& bow) const;
  [[nodiscard]] std::vector<PlaceCandidate> top_candidates(
      const BowVector& words, size_t max_results, const std::function<bool(KeyframeId)>& accept) const;

  size_t max_postings_;
  std::vector<Entry> entries_;  ///< by slot; slots are contiguous, so that scores fit an array
  std::vector<uint32_t> free_slots_;
  std::unordered_map<KeyframeId, uint32_t> slot_of_;
  std::vector<std::vector<Posting>> postings_;  ///< by word
};

}  // namespace kinloop
