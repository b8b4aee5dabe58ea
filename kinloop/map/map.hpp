#pragma once
// The one owner of keyframes, landmarks and loop edges. It is touched by one thread and holds no mutex; all
// change goes through the verbs below, which keep both sides of every observation in step.
//
// Where tracking was lost and began anew, the map falls into components whose places relative to each other
// are not known, until a loop edge joins them.

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kinloop/map/keyframe.hpp"
#include "kinloop/map/map_update.hpp"

namespace kinloop {

/// All that a map consists of, e.g. as a file gave it. The index of keyframes and landmarks is their id;
/// `Keyframe::landmark_of` follows from the observations and is not looked at.
struct MapData {
  std::vector<Keyframe> keyframes;
  std::vector<std::optional<Landmark>> landmarks;  ///< empty where erased
  std::vector<LoopEdge> loop_edges;
  uint32_t component_count = 0;
};

class Map {
 public:
  // Growing.

  /// Adds all of another map behind what is there, as components of their own: its ids, and the numbers of
  /// its components, shift by how many there were.
  void append(MapData parts);

  /// Adds a keyframe that observes nothing yet to a component; `component_count()` begins a new one.
  KeyframeId add_keyframe(FrameId frame, int64_t stamp_ns, const SE3& T_world_camera,
                          std::shared_ptr<const Features> features, uint32_t component = 0);

  /// Adds a landmark first seen as keypoint `feature` of `anchor`, at `p_anchor` in its camera frame.
  LandmarkId add_landmark(KeyframeId anchor, uint32_t feature, const Eigen::Vector3d& p_anchor);

  /// Notes that a keyframe sees a landmark. False, and nothing changes, where the keypoint already shows a
  /// landmark or the keyframe already sees this one.
  bool add_observation(LandmarkId landmark, const Observation& observation);

  /// Adds a loop edge between two keyframes. Where it ties two components together they become one, the
  /// older, and the keyframes of the younger move with their landmarks to where the edge says.
  void add_loop_edge(const LoopEdge& edge);

  // Shrinking.

  /// Forgets one observation; a landmark that is left with none is erased.
  void remove_observation(LandmarkId landmark, Observation observation);

  void erase(LandmarkId landmark);

  /// `from` turns out to be `into`: its observations are moved where they fit, the rest is forgotten.
  void merge(LandmarkId from, LandmarkId into);

  // Correcting.

  /// Applies an update and says whether it did: one with an older epoch than the map's is stale and dropped.
  bool apply(const MapUpdate& update);

  /// Replaces what is known of a keyframe's keypoints, e.g. where a camera at rest would have seen them;
  /// they stay the same keypoints in the same order.
  void set_features(KeyframeId id, std::shared_ptr<const Features> features);

  /// Raised after what bends the whole map (loop correction, full adjustment, self-calibration), so that
  /// updates computed before it are dropped.
  void advance_epoch() { ++epoch_; }

  // Looking.

  [[nodiscard]] uint32_t epoch() const { return epoch_; }

  /// How many components were ever begun.
  [[nodiscard]] uint32_t component_count() const { return component_count_; }

  [[nodiscard]] bool contains(LandmarkId id) const;
  [[nodiscard]] bool contains(KeyframeId id) const { return id.value < keyframes_.size(); }
  /// The landmark that `id` was merged into, or `id` itself. It may have been erased since.
  [[nodiscard]] LandmarkId resolve_merged(LandmarkId id) const;
  [[nodiscard]] const Keyframe& keyframe(KeyframeId id) const;
  [[nodiscard]] const Landmark& landmark(LandmarkId id) const;
  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] const std::vector<LoopEdge>& loop_edges() const { return loop_edges_; }
  /// A copy of everything; `append` to an empty map gives the map back.
  [[nodiscard]] MapData data() const { return {keyframes_, landmarks_, loop_edges_, component_count_}; }

  [[nodiscard]] std::vector<LandmarkId> landmark_ids() const;
  [[nodiscard]] size_t landmark_count() const { return landmark_count_; }

  /// Where a landmark is in the world, m.
  [[nodiscard]] Eigen::Vector3d p_world(LandmarkId id) const;

  /// Keyframes that share at least `min_shared` landmarks with `id`, most shared first (then lower id), with
  /// counts.
  [[nodiscard]] std::vector<std::pair<KeyframeId, int>> covisible_keyframes(KeyframeId id,
                                                                            int min_shared) const;

  /// Throws std::logic_error when the two sides of any observation disagree, for tests.
  void check_invariants() const;

 private:
  Keyframe& keyframe_ref(KeyframeId id);
  Landmark& landmark_ref(LandmarkId id);
  void move_anchor(Landmark& landmark);
  void merge_components(const LoopEdge& edge);
  void propagate_correction(size_t first, const std::vector<SE3>& T_world_camera_before);
  void check_appended(size_t first_keyframe, size_t first_landmark) const;
  void check_landmark(const Landmark& landmark) const;

  std::vector<Keyframe> keyframes_;                 // index = id
  std::vector<std::optional<Landmark>> landmarks_;  // index = id; empty where erased
  std::map<LandmarkId, LandmarkId> merged_into_;
  std::vector<LoopEdge> loop_edges_;
  size_t landmark_count_ = 0;
  uint32_t component_count_ = 0;
  uint32_t epoch_ = 0;
};

}  // namespace kinloop
