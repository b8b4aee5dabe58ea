#pragma once
// The places of a run by what they look like. In: keyframes. Out: where a frame is, which earlier keyframes
// a new one resembles.

#include <optional>

#include "kinloop/loop/verify_loop.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary.hpp"
#include "kinloop/slam/options.hpp"

namespace kinloop {

class PlaceRecognition {
 public:
  PlaceRecognition(const PinholeCamera& camera, const SlamOptions& options, Vocabulary vocabulary)
      : camera_(camera), options_(options), vocabulary_(std::move(vocabulary)) {}

  /// Adds a new keyframe of the map to the index.
  void add(const Keyframe& keyframe);

  /// The pose of `frame` relative to the keyframe it resembles most among those that geometry confirms.
  [[nodiscard]] std::optional<TrackResult> relocalize(const PreparedFrame& frame, const Map& map) const;

  /// Earlier keyframes that `keyframe`, the latest that was added, may show again.
  LoopCandidates find_loops(const Map& map, KeyframeId keyframe);

  /// Begins a new sequence: the next keyframe does not follow the last.
  void forget_history() { history_.clear(); }

 private:
  [[nodiscard]] BowVector bow_of(const Features& features) const;

  PinholeCamera camera_;
  SlamOptions options_;
  Vocabulary vocabulary_;
  PlaceIndex index_;
  CandidateHistory history_;
};

/// The seed of all random choices for a frame.
uint64_t seed_of(const SlamOptions& options, FrameId frame);

}  // namespace kinloop
