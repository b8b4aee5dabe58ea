#pragma once
// In: the share of a processor core that a run may take. Out: options with which it does less for each frame.

#include <string>
#include <vector>

namespace kinloop {

/// A way to do less for each frame.
struct WorkLevel {
  double percent;                        ///< of one core at 30 Hz, see docs/tune.md
  std::vector<std::string> assignments;  ///< key=value
};

/// Returns the levels, from that of the defaults to that of the least work. Each one takes less than the one
/// before, and costs accuracy.
const std::vector<WorkLevel>& work_levels();

/// Returns the most accurate level that takes at most `percent` of a core; the last one if none does.
const WorkLevel& work_level(double percent);

}  // namespace kinloop
