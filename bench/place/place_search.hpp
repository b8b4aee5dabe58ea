#pragma once
// In: the words of keyframes with their image positions. Out: the keyframes that show the same words in the
// same arrangement as a query.

#include <unordered_map>

#include "bench/place/image_words.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

struct PlaceSearchOptions {
  size_t max_verified = 30;         ///< keyframes of the index that are verified geometrically
  int max_signature_distance = 16;  ///< bits of 64 in which two points of one word may differ
  double tolerance_px = 40;         ///< parallax of a moving camera: no similarity fits all points
};

/// An index with geometric verification.
class PlaceSearch {
 public:
  explicit PlaceSearch(const PlaceSearchOptions& options = {}) : options_(options) {}

  /// `keyframe` must not be in the index.
  void add(KeyframeId keyframe, BowVector bow, ImageWords words);

  /// Removes a culled keyframe; it must be in the index.
  void remove(KeyframeId keyframe);

  /// Returns the keyframes with the most geometrically consistent matches (PlaceCandidate::score), best
  /// first; ties by similarity.
  [[nodiscard]] std::vector<PlaceCandidate> query(const BowVector& bow, const ImageWords& words,
                                                  size_t max_results,
                                                  const std::function<bool(KeyframeId)>& accept = {}) const;

  [[nodiscard]] const PlaceIndex& index() const { return index_; }

 private:
  PlaceSearchOptions options_;
  PlaceIndex index_;
  std::unordered_map<KeyframeId, ImageWords> words_of_;
};

}  // namespace kinloop
