#pragma once
// In: an estimate and ground truth, of which one may be stated in another way. Out: the offset between their
// clocks, and the order of their quaternions.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/trajectory.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

/// Finds the offset, to be added to the stamps of the estimate, at which turning and moving speeds correlate
/// best, and refines it to the least position error after alignment. Needs neither a common world nor a
/// common time. nullopt if the motion does not tell: no overlap of at least 3 s and half of the shorter
/// trajectory, speeds that correlate poorly, or about as well at another offset.
std::optional<int64_t> estimate_clock_offset(const Trajectory& estimate, const Trajectory& truth);

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
