#pragma once
// The single owner of keyframes, landmarks and loop closures. It is used by one thread and has no mutex; all
// changes go through the functions below, which keep both directions of every observation consistent.
// After tracking loss the map consists of several components whose relative poses are unknown until a loop
// closure joins them. Each keyframe knows in which component it was made, its visit, and each loop closure
// which keyframes it joins: where the loop closures between visits are withdrawn, the components are parted.

#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kinloop/map/covisibility.hpp"
#include "kinloop/map/keyframe.hpp"
#include "kinloop/map/loop_closure.hpp"
#include "kinloop/map/map_update.hpp"

namespace kinloop {

/// The whole content of a map, e.g. as read from a file. Keyframes and landmarks are indexed by id;
/// `Keyframe::landmark_of` is rebuilt from the observations and ignored.
struct MapData {
  std::vector<Keyframe> keyframes;
  std::vector<std::optional<Landmark>> landmarks;  ///< nullopt if erased
  std::vector<LoopClosure> loop_closures;          ///< accepted
  std::vector<LoopClosure> other_loops;            ///< provisional, rejected and withdrawn
  uint32_t component_count = 0;
};

/// Landmarks that two keyframes must share to be covisible.
inline constexpr int kMinCovisibleLandmarks = 15;

/// A map of keyframes, landmarks and loop closures.
class Map {
 public:
  // Growing.

  /// Appends another map as separate components: its ids and component numbers are offset by the current
  /// counts.
  void append(MapData parts);

  /// Adds a keyframe without observations to a component; `component_count()` begins a new component and
  /// visit. Otherwise it continues the visit of the latest keyframe of the component, see `set_visit`.
  KeyframeId add_keyframe(FrameId frame, int64_t stamp_ns, const SE3& T_world_camera,
                          std::shared_ptr<const Features> features, uint32_t component = 0);

  /// Adds a landmark at `p_anchor` in the camera frame of `anchor`, first observed as its keypoint `feature`.
  LandmarkId add_landmark(KeyframeId anchor, uint32_t feature, const Eigen::Vector3d& p_anchor);

  /// Adds an observation. Returns false and changes nothing if the keypoint already observes a landmark or
  /// the keyframe already observes this one.
  bool add_observation(LandmarkId landmark, const Observation& observation);

  /// Accepts a verified loop closure. If it connects two components, they are merged into the older one, and
  /// the keyframes and landmarks of the newer one are moved according to its measurement.
  void add_loop_closure(LoopClosure loop);

  /// Remembers a loop closure that is no edge: provisional, rejected or withdrawn. Replaces what is known of
  /// one between the same keyframes.
  void record_loop(const LoopClosure& loop);

  // Shrinking.

  /// Takes loop closures back, for `reason`: they are no edges any more, landmarks that they merged are again
  /// what they were, those that only they have tied together since are split, and so are components that only
  /// they have joined. Poses stay as they are. The
  /// epoch does not advance. If components were parted, returns T_world_camera of all keyframes before, else
  /// nothing.
  std::vector<SE3> withdraw_loops(std::span<const LoopEnds> loops, LoopReason reason);

  /// Removes an observation; erases a landmark left without any.
  void remove_observation(LandmarkId landmark, Observation observation);

  void erase(LandmarkId landmark);

  /// Takes a keyframe whose pose has turned out to be wrong out of use: it loses its observations and loop
  /// closures and becomes a component of its own.
  void withdraw(KeyframeId id);

  /// Merges `from` into `into`: moves its observations where possible and drops the others.
  void merge(LandmarkId from, LandmarkId into);

  /// Marks loop closures as those that the map has been corrected for.
  void mark_corrected(std::span<const LoopEnds> loops);

  // Correcting.

  /// Applies an update and returns true, unless its epoch is older than the map's; such an update is stale
  /// and dropped.
  bool apply(const MapUpdate& update);

  /// Replaces a keyframe's keypoint measurements, e.g. after motion compensation; number and order must stay
  /// the same.
  void set_features(KeyframeId id, std::shared_ptr<const Features> features);

  /// Stores image patches of the keypoints of a keyframe.
  void set_patches(KeyframeId id, KeypointPatches patches);

  /// Stores how a keyframe follows from the one that it was tracked against.
  void set_odometry(KeyframeId id, const OdometryStep& step);

  /// Says in which visit a keyframe was made, one of those of its component.
  void set_visit(KeyframeId id, uint32_t visit);

  /// Stores the surfaces that a keyframe shows.
  void set_surfaces(KeyframeId id, std::shared_ptr<const SurfaceGrid> surfaces);

  /// Increments the epoch after a correction of the whole map (loop correction, global bundle adjustment,
  /// self-calibration), so that updates computed before it are dropped.
  void advance_epoch() { ++epoch_; }

  // Looking.

  [[nodiscard]] uint32_t epoch() const { return epoch_; }

  /// Number of components ever created.
  [[nodiscard]] uint32_t component_count() const { return component_count_; }

  [[nodiscard]] bool contains(LandmarkId id) const;
  [[nodiscard]] bool contains(KeyframeId id) const { return id.value < keyframes_.size(); }
  /// Returns the landmark that `id` was merged into, or `id` itself. It may have been erased since.
  [[nodiscard]] LandmarkId resolve_merged(LandmarkId id) const;
  [[nodiscard]] const Keyframe& keyframe(KeyframeId id) const;
  [[nodiscard]] const Landmark& landmark(LandmarkId id) const;
  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] const std::vector<LoopClosure>& loop_closures() const { return loop_closures_; }
  /// Loop closures that are no edges: provisional, rejected or withdrawn. Not in map files.
  [[nodiscard]] const std::vector<LoopClosure>& other_loops() const { return other_loops_; }
  /// Returns a copy of everything; `append` to an empty map restores the map.
  [[nodiscard]] MapData data() const {
    return {keyframes_, landmarks_, loop_closures_, other_loops_, component_count_};
  }

  [[nodiscard]] std::vector<LandmarkId> landmark_ids() const;
  [[nodiscard]] size_t landmark_count() const { return landmark_count_; }

  /// Returns T_a_b of two keyframes of one component.
  [[nodiscard]] SE3 relative_pose(KeyframeId a, KeyframeId b) const {
    return keyframe(a).T_world_camera.inverse() * keyframe(b).T_world_camera;
  }

  /// Returns T_world_camera of all keyframes, by id.
  [[nodiscard]] std::vector<SE3> keyframe_poses() const;

  /// Returns the keyframe before this one in its visit; nullopt if the motion from there is unknown.
  [[nodiscard]] std::optional<KeyframeId> predecessor(KeyframeId id) const;

  /// Returns the position of a landmark in the world frame, m.
  [[nodiscard]] Eigen::Vector3d p_world(LandmarkId id) const;

  /// Returns the keyframes that share at least `min_shared` landmarks with `id`, with counts, most shared
  /// first (ties by lower id).
  [[nodiscard]] std::vector<std::pair<KeyframeId, int>> covisible_keyframes(KeyframeId id,
                                                                            int min_shared) const;

  /// Throws std::logic_error if the two directions of any observation disagree; for tests.
  void check_invariants() const;

 private:
  Keyframe& keyframe_ref(KeyframeId id);
  Landmark& landmark_ref(LandmarkId id);
  void move_anchor(Landmark& landmark);
  void merge_components(const LoopClosure& loop);
  void split_components();
  void undo_merge(const MergedLandmark& merged);
  void split_landmarks(const std::vector<uint32_t>& side_of);
  void split_tracks(const LoopEnds& loop);
  void split(LandmarkId id, const std::vector<Observation>& moved);
  void propagate_correction(size_t first, const std::vector<SE3>& T_world_camera_before);
  void check_appended(size_t first_keyframe, size_t first_landmark) const;
  void check_landmark(const Landmark& landmark) const;

  std::vector<Keyframe> keyframes_;                 // index = id
  std::vector<std::optional<Landmark>> landmarks_;  // index = id; nullopt if erased
  Covisibility covisibility_;
  /// What a landmark was merged into, and one of its observers then.
  struct Merged {
    LandmarkId into;
    KeyframeId observer;
  };
  std::map<LandmarkId, Merged> merged_into_;
  std::map<LoopEnds, std::vector<MergedLandmark>> merged_by_loop_;  // of accepted ones of this run
  std::vector<LoopClosure> loop_closures_;                          // accepted
  std::vector<LoopClosure> other_loops_;                            // provisional, rejected and withdrawn
  size_t landmark_count_ = 0;
  uint32_t component_count_ = 0;
  uint32_t epoch_ = 0;
};

}  // namespace kinloop
