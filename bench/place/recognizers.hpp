#pragma once
// Recognition methods: by words, by words with geometric verification, by the whole detector. raw_search.hpp
// has those without words.

#include <functional>
#include <vector>

#include "bench/place/places.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// The answers of one method, and the query time without quantisation, ms.
struct Recognition {
  std::vector<Answer> answers;
  double query_ms = 0;
};

/// Places are indexed by their number.
inline KeyframeId id_of(size_t place) {
  return {static_cast<uint32_t>(place)};
}

/// Queries each image that has a pose; `ask` returns the candidates, best first.
Recognition recognize(std::span<const Place> places,
                      const std::function<std::vector<PlaceCandidate>(size_t query)>& ask);

/// By the L1 score of bags of words.
Recognition by_words(std::span<const Place> places, const Vocabulary& vocabulary);

/// By the number of geometrically consistent word matches (PlaceSearch).
Recognition by_geometric_verification(std::span<const Place> places, const Vocabulary& vocabulary);

/// Outcome of the geometric verification of candidates.
struct Detection {
  size_t confirmed = 0;    ///< images with a confirmed loop
  size_t same = 0;         ///< ... of those with an admissible kSame
  size_t off = 0;          ///< ... with a pose error of more than 0.2 m or 10 degrees
  size_t other_scene = 0;  ///< ... in another scene
};

/// Runs the whole detector on single images: the best five candidates, verified as in loop closing.
Detection detect(std::span<const Place> places, const Vocabulary& vocabulary, const PinholeCamera& camera);

}  // namespace kinloop
