#include "bench/place/place_search.hpp"

#include <algorithm>

namespace kinloop {

void PlaceSearch::add(KeyframeId keyframe, BowVector bow, ImageWords words) {
  index_.add(keyframe, std::move(bow));
  words_of_.emplace(keyframe, std::move(words));
}

void PlaceSearch::remove(KeyframeId keyframe) {
  index_.remove(keyframe);
  words_of_.erase(keyframe);
}

std::vector<PlaceCandidate> PlaceSearch::query(const BowVector& bow, const ImageWords& words,
                                               size_t max_results,
                                               const std::function<bool(KeyframeId)>& accept) const {
  auto candidates = index_.query(bow, std::max(options_.max_verified, max_results), accept);
  for (auto& [keyframe, score] : candidates) {
    const ImageWords& there = words_of_.at(keyframe);
    const auto matches = match_words(words, there, options_.max_signature_distance);
    score = static_cast<double>(geometric_support(words, there, matches, options_.tolerance_px));
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  candidates.resize(std::min(max_results, candidates.size()));
  return candidates;
}

}  // namespace kinloop
