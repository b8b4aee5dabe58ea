#pragma once
// Aligns two views of what may be one place, whose relative pose is known but for drift: 5 to 10 cm of it
// make views of one place look as different as those of two.

#include <optional>

#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/loop/verification/view_checks.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Two views that agree on a relative pose.
struct AlignedViews {
  SE3 T_reference_camera;
  RelativeScale scale;  ///< of the matched keypoints at rest; of a double, which parts are elsewhere, not 1
};

/// Returns the relative pose on which the keypoints of two views agree, if drift explains how far it is from
/// the predicted one; nullopt if too few agree.
std::optional<AlignedViews> align_views(const View& reference, const View& view,
                                        const PredictedView& predicted, const Sensor& sensor);

}  // namespace kinloop
