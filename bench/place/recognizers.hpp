#pragma once
// Ways to find, for each image, the image that shows the same place: by words, by words and their
// arrangement, by the whole detector. raw_search.hpp has those without words.

#include <functional>
#include <vector>

#include "bench/place/places.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// The answers of one method, and the time of a query once the words are known, ms.
struct Recognition {
  std::vector<Answer> answers;
  double query_ms = 0;
};

/// A place is known to the index by its number.
inline KeyframeId id_of(size_t place) {
  return {static_cast<uint32_t>(place)};
}

/// Asks for each image that has a pose; `ask` gives the candidates, best first.
Recognition recognize(std::span<const Place> places,
                      const std::function<std::vector<PlaceCandidate>(size_t query)>& ask);

/// By the L1 score of bags of words.
Recognition by_words(std::span<const Place> places, const Vocabulary& vocabulary);

/// By how many matches of words agree on the arrangement (PlaceSearch).
Recognition by_geometric_verification(std::span<const Place> places, const Vocabulary& vocabulary);

/// What became of the candidates of the vocabulary that geometry confirms.
struct Detection {
  size_t confirmed = 0;    ///< images with a confirmed loop
  size_t same = 0;         ///< ... of those for which there is a kSame to be found
  size_t off = 0;          ///< ... whose pose is off by more than 0.2 m or 10 degrees
  size_t other_scene = 0;  ///< ... in another scene
};

/// The whole detector on single images: the best five candidates, verified as loop closing does.
Detection detect(std::span<const Place> places, const Vocabulary& vocabulary, const PinholeCamera& camera);

}  // namespace kinloop
