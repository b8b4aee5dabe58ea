#include "kinloop/place/place_index.hpp"

#include <algorithm>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

bool better(const PlaceCandidate& a, const PlaceCandidate& b) {
  return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
}

/// Keeps the best candidates in a bounded heap; of 200,000 images few ever enter it.
class Best {
 public:
  explicit Best(size_t most) : most_(most) {}

  /// Lower scores are rejected.
  [[nodiscard]] double floor() const {
    return heap_.size() < most_ || heap_.empty() ? 0 : heap_.front().score;
  }

  [[nodiscard]] bool wants(const PlaceCandidate& candidate) const {
    return heap_.size() < most_ || (most_ > 0 && better(candidate, heap_.front()));
  }

  void add(const PlaceCandidate& candidate) {
    if (heap_.size() == most_) {
      std::pop_heap(heap_.begin(), heap_.end(), better);
      heap_.pop_back();
    }
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end(), better);
  }

  /// Best first.
  [[nodiscard]] std::vector<PlaceCandidate> sorted() && {
    std::sort_heap(heap_.begin(), heap_.end(), better);
    return std::move(heap_);
  }

 private:
  size_t most_;
  std::vector<PlaceCandidate> heap_;  // worst at the front
};

}  // namespace

void PlaceIndex::add(KeyframeId keyframe, BowVector bow) {
  require(keyframe.valid() && !contains(keyframe), "PlaceIndex::add: the keyframe is already in the index");
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
  const BowVector telling = without_stop_words(bow);
  if (telling.size() == bow.size()) return top_candidates(bow, max_results, accept);
  constexpr size_t kCandidatesPerResult =
      10;  // candidates per result, since their order may differ from that of the scores
  Best best(max_results);
  for (const auto& found :
       top_candidates(telling, kCandidatesPerResult * std::min(max_results, size()), accept)) {
    const PlaceCandidate candidate{found.keyframe, similarity(bow, bow_of(found.keyframe))};
    if (best.wants(candidate)) best.add(candidate);
  }
  return std::move(best).sorted();
}

BowVector PlaceIndex::without_stop_words(const BowVector& bow) const {
  const auto length_of = [&](WordId word) {
    return word.value < postings_.size() ? postings_[word.value].size() : 0;
  };
  size_t postings = 0;
  for (const auto& [word, weight] : bow) postings += length_of(word);
  if (postings <= max_postings_) return bow;
  BowVector words = bow;
  std::stable_sort(words.begin(), words.end(),
                   [&](const auto& a, const auto& b) { return length_of(a.first) < length_of(b.first); });
  while (!words.empty() && postings > max_postings_) {
    postings -= length_of(words.back().first);
    words.pop_back();
  }
  return words;
}

std::vector<PlaceCandidate> PlaceIndex::top_candidates(const BowVector& words, size_t max_results,
                                                       const std::function<bool(KeyframeId)>& accept) const {
  // The same terms in the same order of words as in `similarity`, so scores are identical to the last bit.
  std::vector<double> scores(entries_.size(), 0);
  for (const auto& [word, weight] : words) {
    if (word.value >= postings_.size()) continue;
    for (const Posting& posting : postings_[word.value])
      scores[posting.slot] += std::min(weight, posting.weight);
  }
  Best best(max_results);
  for (size_t slot = 0; slot < scores.size(); ++slot) {
    if (scores[slot] == 0 || scores[slot] < best.floor()) continue;
    const PlaceCandidate candidate{entries_[slot].keyframe, std::min(scores[slot], 1.0)};
    if (best.wants(candidate) && (!accept || accept(candidate.keyframe))) best.add(candidate);
  }
  return std::move(best).sorted();
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
