#pragma once
// The tracker's copy of the map: landmarks around a reference keyframe.

#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/options.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

struct LocalMapOptions {
  int max_keyframes = 20;
  int max_landmarks = 4000;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_keyframes", self.max_keyframes, "maximum number of keyframes in the local map", Range{1, 200});
    visit("max_landmarks", self.max_landmarks, "maximum number of landmarks in the local map",
          Range{100, 100000});
  }
};

/// An observing keyframe of a local map.
struct LocalView {
  KeyframeId keyframe;
  SE3 T_keyframe_reference;
  std::shared_ptr<const Features> features;
  std::shared_ptr<const KeypointPatches> patches;  ///< may be null
  std::shared_ptr<const SurfaceGrid> surfaces;     ///< null in a loaded map
};

/// Landmarks in the frame of `reference`, as a structure of arrays.
struct LocalMap {
  KeyframeId reference;
  std::shared_ptr<const Features> features;     ///< all keypoints of the reference
  std::shared_ptr<const SurfaceGrid> surfaces;  ///< of the reference; null in a loaded map
  std::vector<LandmarkId> ids;
  std::unordered_map<LandmarkId, uint32_t> index_of;  ///< inverse of `ids`
  std::vector<Eigen::Vector3d> p_reference;           ///< m
  std::vector<bool> confirmed;                        ///< whether several keyframes agree on its position
  std::vector<bool> has_depth;                        ///< whether one of them has measured its depth
  std::vector<Eigen::Vector3d>
      viewing_directions;                    ///< unit vectors from the landmark towards an observing camera
  std::vector<double> observed_distances_m;  ///< distance from that camera
  std::vector<int> observed_levels;          ///< pyramid level in that camera
  cv::Mat descriptors;                       ///< one row per landmark, from that camera
  std::vector<LocalView> views;              ///< the observing cameras
  std::vector<uint32_t> view_of;             ///< per landmark, index into `views`
  std::vector<uint32_t> feature_of;          ///< per landmark, its keypoint there

  [[nodiscard]] size_t size() const { return ids.size(); }
};

/// Copies the landmarks of `reference`, of the keyframes that share the most landmarks with it, and of
/// `others`.
LocalMap make_local_map(const Map& map, KeyframeId reference, const LocalMapOptions& options,
                        std::span<const KeyframeId> others = {});

/// Returns how many of the matched landmarks are of known depth.
int count_with_depth(std::span<const LandmarkMatch> matches, const LocalMap& local_map);

/// Projects landmarks into a camera at `T_reference_camera`, with a search window of half side `window_px` on
/// level 0.
struct LandmarkProjector {
  const LocalMap& local_map;
  const Features& features;
  const PinholeCamera& camera;
  SE3 T_reference_camera;
  double window_px = 0;

  /// nullopt if the landmark is out of view or the viewing direction differs too much.
  [[nodiscard]] std::optional<ProjectedPoint> operator()(uint32_t index) const;
};

}  // namespace kinloop
