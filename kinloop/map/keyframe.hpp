#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "kinloop/core/ids.hpp"
#include "kinloop/features/features.hpp"
#include "kinloop/features/patches.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// The step of odometry to a keyframe.
struct OdometryStep {
  KeyframeId reference;  ///< the keyframe that it was tracked against; invalid for the first of a component
  /// Of x = (translation [m]; rotation [rad]), where the true pose is T_reference_keyframe * exp(x).
  Matrix6d covariance = Matrix6d::Zero();
};

/// A frame kept in the map. `landmark_of` has one entry per keypoint, an invalid id if it observes no
/// landmark.
struct Keyframe {
  KeyframeId id;
  FrameId frame;
  int64_t stamp_ns = 0;
  uint32_t component = 0;  ///< poses of different components are not comparable
  uint32_t visit = 0;      ///< the component in which it was made; differs where loops have joined components
  bool begins_component = false;  ///< its motion from earlier keyframes is unknown
  bool withdrawn = false;         ///< its pose turned out to be wrong, see Map::withdraw; not in map files
  SE3 T_world_camera;
  std::shared_ptr<const Features> features;
  std::vector<LandmarkId> landmark_of;
  std::optional<OdometryStep> odometry = {};            ///< nullopt in a loaded map
  std::shared_ptr<const KeypointPatches> patches = {};  ///< null in a loaded map
  std::shared_ptr<const SurfaceGrid> surfaces = {};     ///< null in a loaded map, see restore_surfaces
};

/// Keypoint `feature` of `keyframe`.
struct Observation {
  KeyframeId keyframe;
  uint32_t feature = 0;

  auto operator<=>(const Observation&) const = default;  // NOLINT(modernize-use-nullptr): as in ids.hpp
};

/// A 3D point, stored relative to the keyframe that first saw it, so that it follows when that keyframe is
/// corrected.
struct Landmark {
  LandmarkId id;
  KeyframeId anchor;
  Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();  ///< in the anchor's camera frame, m
  std::vector<Observation> observations;               ///< in order of insertion
};

}  // namespace kinloop
