#pragma once
// In: two trajectories in one clock. Out: which poses are compared.

#include <vector>

#include "kinloop/core/association.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Whose figures an evaluation reproduces.
enum class Convention {
  kTum,  ///< the tools of the TUM RGB-D benchmark: closest pairs first, each pose once
  kEvo  ///< evo_ape and evo_rpe --all_pairs: for each pose of the shorter trajectory the closest of the other
};

constexpr auto option_names(Convention) {
  using enum Convention;
  return std::to_array<EnumName<Convention>>({{kTum, "tum"}, {kEvo, "evo"}});
}

/// Seconds as tools in Python store them: a double resolves 0.24 us of Unix time. Stamps of four decimals
/// often lie exactly midway between two others, where the choice depends on this rounding.
double rounded_seconds(int64_t stamp_ns);

/// Returns the pairs (a: truth, b: estimate) that are at most `max_difference_ns` apart, sorted by time.
std::vector<StampPair> pair_poses(const Trajectory& estimate, const Trajectory& truth,
                                  int64_t max_difference_ns, Convention convention);

}  // namespace kinloop
