#pragma once
// Aligns two views of what may be one place, whose relative pose is known but for drift: 5 to 10 cm of it
// make views of one place look as different as those of two.

#include <optional>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/loop/drift.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Returns the relative pose on which the keypoints of two views agree, if drift explains how far it is from
/// the predicted one; nullopt if too few agree.
std::optional<SE3> align_views(const Features& reference, const Features& features,
                               const PredictedView& predicted, const Sensor& sensor);

}  // namespace kinloop
