#pragma once
// In: the bags of words of keyframes. Out: for another bag of words the keyframes that look most like it.

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "kinloop/base/ids.hpp"
#include "kinloop/place/bow_vector.hpp"

namespace kinloop {

/// A keyframe that may show the same place, and how alike it looks (0 to 1).
struct PlaceCandidate {
  KeyframeId keyframe;
  double score = 0;

  bool operator==(const PlaceCandidate&) const = default;
};

/// Inverted index: for each word the keyframes that have it (Sivic and Zisserman 2003). A query touches only
/// keyframes with a common word and gives the very scores `similarity` gives.
///
/// Where the words of a query have more than `max_postings` entries together, the words that most keyframes
/// have are stop words for it: those with the shortest lists find the candidates, a few times as many as
/// asked for, and only of these is the score computed. So the time of a query does not grow for ever.
class PlaceIndex {
 public:
  /// Far more than the keyframes of one run have: up to there a query looks at everything.
  static constexpr size_t kMaxPostings = 400'000;

  explicit PlaceIndex(size_t max_postings = kMaxPostings) : max_postings_(max_postings) {}

  /// `keyframe` must not be in the index.
  void add(KeyframeId keyframe, BowVector bow);

  /// Takes a culled keyframe out; it must be in the index.
  void remove(KeyframeId keyframe);

  /// The best `max_results` keyframes with a score above 0 among those `accept` lets pass (all by default),
  /// best first, ties by id.
  [[nodiscard]] std::vector<PlaceCandidate> query(const BowVector& bow, size_t max_results,
                                                  const std::function<bool(KeyframeId)>& accept = {}) const;

  [[nodiscard]] bool contains(KeyframeId keyframe) const { return slot_of_.contains(keyframe); }

  /// The bag of words `keyframe` was added with; it must be in the index.
  [[nodiscard]] const BowVector& bow_of(KeyframeId keyframe) const;

  [[nodiscard]] size_t size() const { return slot_of_.size(); }

 private:
  struct Entry {
    KeyframeId keyframe;  ///< none in a free slot
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
  std::vector<Entry> entries_;  ///< by slot; slots are numbered without gaps, so that scores fit an array
  std::vector<uint32_t> free_slots_;
  std::unordered_map<KeyframeId, uint32_t> slot_of_;
  std::vector<std::vector<Posting>> postings_;  ///< by word
};

}  // namespace kinloop
