#pragma once
// In: the words of keyframes and where they are in the image. Out: for another image the keyframes that show
// the same words in the same arrangement.

#include <unordered_map>

#include "bench/place/image_words.hpp"
#include "kinloop/place/place_index.hpp"

namespace kinloop {

struct PlaceSearchOptions {
  size_t max_verified = 30;         ///< keyframes of the index whose arrangement is looked at
  int max_signature_distance = 16;  ///< bits of 64 in which two points of one word may differ
  double tolerance_px = 40;         ///< a camera that moved sees depth: no similarity fits it all
};

/// An index with a second look.
class PlaceSearch {
 public:
  explicit PlaceSearch(const PlaceSearchOptions& options = {}) : options_(options) {}

  /// `keyframe` must not be known.
  void add(KeyframeId keyframe, BowVector bow, ImageWords words);

  /// Takes a culled keyframe out; it must be known.
  void remove(KeyframeId keyframe);

  /// The keyframes whose words support each other most (PlaceCandidate::score = number of matches that
  /// agree), best first; among equals the more alike first.
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
