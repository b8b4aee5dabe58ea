#pragma once
// In: two trajectories of one motion, stamped by different clocks. Out: the offset between the clocks.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Finds the offset, to be added to the stamps of the estimate, at which turning and moving speeds correlate
/// best, and refines it to the least position error after alignment. Needs neither a common world nor a
/// common time. nullopt if the motion does not tell: no overlap of at least 3 s and half of the shorter
/// trajectory, speeds that correlate poorly, or about as well at another offset.
std::optional<int64_t> estimate_clock_offset(const Trajectory& estimate, const Trajectory& truth);

}  // namespace kinloop
