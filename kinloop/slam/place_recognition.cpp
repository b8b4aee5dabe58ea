#include "kinloop/slam/place_recognition.hpp"

#include "kinloop/base/random.hpp"
#include "kinloop/loop/relocalize.hpp"

namespace kinloop {

uint64_t seed_of(const SlamOptions& options, FrameId frame) {
  return hash(static_cast<uint64_t>(options.seed), frame.value);
}

BowVector PlaceRecognition::bow_of(const Features& features) const {
  return vocabulary_.bow_of(vocabulary_.quantize(features.descriptors).words);
}

void PlaceRecognition::add(const Keyframe& keyframe) {
  index_.add(keyframe.id, bow_of(*keyframe.features));
}

std::optional<TrackResult> PlaceRecognition::relocalize(const PreparedFrame& frame, const Map& map) const {
  return kinloop::relocalize(frame, bow_of(*frame.features), map, index_, camera_, options_.local_map,
                             options_.loop, options_.tracking, seed_of(options_, frame.id));
}

LoopCandidates PlaceRecognition::find_loops(const Map& map, KeyframeId keyframe) {
  LoopDetection detected = find_loop_candidates(map, index_, keyframe, history_, options_.loop);
  history_ = std::move(detected.history);
  return make_loop_candidates(map, keyframe, detected.keyframes, options_.local_map,
                              seed_of(options_, map.keyframe(keyframe).frame));
}

}  // namespace kinloop
