#pragma once
// What the tracker sees of the map: landmarks around a reference keyframe, copied out.

#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/options.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

struct LocalViewOptions {
  int max_keyframes = 20;
  int max_landmarks = 4000;
  int min_shared = 15;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_keyframes", self.max_keyframes, "covisible keyframes whose landmarks are tracked",
          Range{1, 200});
    visit("max_landmarks", self.max_landmarks, "landmarks tracked at most", Range{100, 100000});
    visit("min_shared", self.min_shared, "shared landmarks that make two keyframes covisible",
          Range{1, 1000});
  }
};

/// Landmarks in the frame of `reference`; structure of arrays.
struct LocalView {
  KeyframeId reference;
  std::shared_ptr<const Features> features;  ///< all key points of the reference
  std::vector<LandmarkId> ids;
  std::vector<Eigen::Vector3d> p_reference;  ///< m
  std::vector<Eigen::Vector3d> viewed_from;  ///< unit vectors from the landmark towards a camera that saw it
  std::vector<double> seen_distance_m;       ///< distance from that camera
  std::vector<int> seen_level;               ///< pyramid level on which that camera saw it
  cv::Mat descriptors;                       ///< one row per landmark, as that camera saw it

  [[nodiscard]] size_t size() const { return ids.size(); }
};

/// The landmarks of `reference` and of the keyframes that share most landmarks with it.
LocalView make_local_view(const Map& map, KeyframeId reference, const LocalViewOptions& options);

/// Where landmark `index` of the view should appear to a camera at `T_reference_camera`, with a search window
/// of `window_px` (half side) on level 0; nothing where it is out of sight or seen from too different a side.
std::optional<ProjectedPoint> project_landmark(const LocalView& view, uint32_t index,
                                               const Features& features, const SE3& T_reference_camera,
                                               double window_px, const PinholeCamera& camera);

}  // namespace kinloop
