#pragma once
// How far the keyframes of a run may have drifted after the final adjustment.

#include <optional>
#include <span>
#include <vector>

#include "kinloop/map/frames/online_covariance.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns the covariance of the drift of each keyframe, by id, of (translation [m]; rotation [rad]) in its
/// axes, relative to the first keyframe of its component. The errors of successive keyframes are correlated,
/// which no residual of the adjustment shows, and so add up along the `steps` of tracking (by id, see
/// OnlineCovariance::steps), until the camera sees again what it had left: that ties both visits together.
/// Keyframes without a step, those of loaded maps, are exact.
std::vector<Matrix6d> drift_covariances(const Map& map, std::span<const std::optional<KeyframeStep>> steps);

}  // namespace kinloop
