#pragma once
// Recognizes places by appearance: relocalizes frames and finds loop candidates for keyframes.

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kinloop/loop/recognition/candidates.hpp"
#include "kinloop/loop/verification/location_check.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

class PlaceRecognition {
 public:
  PlaceRecognition(const Sensor& sensor, const PlaceOptions& options, Vocabulary vocabulary)
      : context_{sensor, options}, vocabulary_(std::move(vocabulary)) {}

  /// Adds a new keyframe to the index.
  void add(const Keyframe& keyframe);

  /// Returns the pose of `frame` relative to the most similar keyframe that passes geometric verification and
  /// whose surroundings do not contradict it. nullopt as well if another place fits the frame about as well,
  /// or looks like the place that was found.
  [[nodiscard]] std::optional<TrackedFrame> relocalize(const Frame& frame, const Map& map) const;

  /// Returns whether some keyframe within 5 m looks like another place of its component, as along a corridor
  /// with the same doors. No single frame tells such places apart.
  [[nodiscard]] bool is_aliased(KeyframeId id, const Map& map) const;

  /// Returns what a frame with descriptors says of the place where it is located, compared with the keyframes
  /// before `end`.
  [[nodiscard]] LocationEvidence examine(const TrackedFrame& tracked, const Map& map, KeyframeId end) const;

  /// Returns the pose of `frame` if it is close to T_reference_camera and many landmarks agree.
  [[nodiscard]] std::optional<TrackedFrame> locate_near(const Frame& frame, const Map& map,
                                                        KeyframeId reference,
                                                        const SE3& T_reference_camera) const;

  /// Returns hypotheses of loops between `keyframe` and earlier keyframes or those of other components, to be
  /// verified.
  [[nodiscard]] LoopVerificationProblem find_loops(const Map& map, KeyframeId keyframe) const;

 private:
  /// What has been looked at to find an alias of a view.
  struct AliasSearch {
    uint32_t epoch = 0;     // of the map
    uint32_t compared = 0;  // with the keyframes before this one
    bool found = false;
  };

  [[nodiscard]] bool is_aliased(uint32_t component, const Eigen::Vector3d& p_world, const Map& map) const;
  [[nodiscard]] bool is_view_aliased(KeyframeId id, const Map& map) const;
  [[nodiscard]] bool find_alias(KeyframeId id, KeyframeId first, const Map& map) const;
  [[nodiscard]] bool looks_like(const Keyframe& keyframe, const Keyframe& other, const Map& map) const;
  [[nodiscard]] BowVector bow_of(const Features& features) const;
  [[nodiscard]] std::optional<TrackedFrame> locate_at(KeyframeId candidate, const Frame& frame,
                                                      const Map& map) const;
  [[nodiscard]] IndexedView indexed_view(const Keyframe& keyframe) const;

  PlaceContext context_;
  Vocabulary vocabulary_;
  PlaceIndex index_;
  mutable std::map<KeyframeId, AliasSearch> aliases_;  // of the views that were asked for: it takes time
  std::vector<std::vector<NodeId>> nodes_;             // by keyframe id: the vocabulary node of each keypoint
};

}  // namespace kinloop
