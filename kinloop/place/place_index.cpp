#include "kinloop/place/place_index.hpp"

#include <algorithm>

#include "kinloop/base/errors.hpp"

namespace kinloop {

void PlaceIndex::add(KeyframeId keyframe, BowVector bow) {
  require(keyframe.valid() && !contains(keyframe), "PlaceIndex::add: the keyframe is in the index already");
  if (free_slots_.empty()) {
    free_slots_.push_back(static_cast<uint32_t>(entries_.size()));
    entries_.emplace_back();
  }
  const uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  if (!bow.empty() && postings_.size() <= bow.back().first.value)
    postings_.resize(bow.back().first.value + 1);
  for (const auto& [word, weight] : bow) postings_[word.value].push_back({slot, weight});
  entries_[slot] = {keyframe, std::move(bow)};
  slot_of_.emplace(keyframe, slot);
}

void PlaceIndex::remove(KeyframeId keyframe) {
  const uint32_t slot = slot_of(keyframe);
  for (const auto& [word, weight] : entries_[slot].bow) {
    auto& postings = postings_[word.value];
    const auto found = std::find_if(postings.begin(), postings.end(),
                                    [&](const Posting& posting) { return posting.slot == slot; });
    *found = postings.back();
    postings.pop_back();
  }
  entries_[slot] = {};
  free_slots_.push_back(slot);
  slot_of_.erase(keyframe);
}

std::vector<PlaceCandidate> PlaceIndex::query(const BowVector& bow, size_t max_results,
                                              const std::function<bool(KeyframeId)>& accept) const {
  // The same terms in the same order of words as in `similarity`: the same scores to the last bit.
  std::vector<double> scores(entries_.size(), 0);
  for (const auto& [word, weight] : bow) {
    if (word.value >= postings_.size()) break;
    for (const Posting& posting : postings_[word.value])
      scores[posting.slot] += std::min(weight, posting.weight);
  }
  std::vector<PlaceCandidate> candidates;
  for (size_t slot = 0; slot < scores.size(); ++slot) {
    if (scores[slot] == 0 || (accept && !accept(entries_[slot].keyframe))) continue;
    candidates.push_back({entries_[slot].keyframe, std::min(scores[slot], 1.0)});
  }
  const auto better = [](const PlaceCandidate& a, const PlaceCandidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  };
  const auto kept =
      candidates.begin() + static_cast<std::ptrdiff_t>(std::min(max_results, candidates.size()));
  std::partial_sort(candidates.begin(), kept, candidates.end(), better);
  candidates.erase(kept, candidates.end());
  return candidates;
}

const BowVector& PlaceIndex::bow_of(KeyframeId keyframe) const {
  return entries_[slot_of(keyframe)].bow;
}

uint32_t PlaceIndex::slot_of(KeyframeId keyframe) const {
  const auto found = slot_of_.find(keyframe);
  require(found != slot_of_.end(), "PlaceIndex: the keyframe is not in the index");
  return found->second;
}

}  // namespace kinloop
