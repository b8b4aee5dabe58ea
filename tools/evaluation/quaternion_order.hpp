#pragma once
// In: an estimate and ground truth whose quaternions may have been read in the wrong order. Out: which of
// them were.

#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

/// Which of two trajectories.
struct WhichTrajectory {
  bool estimate = false;
  bool truth = false;
};

/// Returns the trajectory with the components of its quaternions, which were read as x y z w, taken as w x y
/// z.
Trajectory with_w_first(Trajectory trajectory);

/// Finds which one has its quaternions as w x y z, of those that `may_be`: with the right order, motions of
/// the two agree far better. Reading both wrongly or one wrongly inverts rotations, which positions alone do
/// not show.
WhichTrajectory find_w_first(const Trajectory& estimate, const Trajectory& truth,
                             const WhichTrajectory& may_be, const EvaluationOptions& options = {});

}  // namespace kinloop
