#pragma once
// In: progress reports. Out: one line on standard error that is redrawn:
//
//   mapping    [============>             ]  512/1000   28.4/s   17 s left   tracking, 44 keyframes, 2 loops
//
// If standard error is a file or a pipe, a new line is printed now and then instead.

#include <string>

#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns a progress bar on standard error, one line per stage; without a terminal, a line every few seconds
/// for longer stages. Prints nothing if `quiet`. The line is terminated when the last copy is destroyed.
/// Never asks the work to stop.
Progress make_progress_bar(bool quiet = false);

/// Elapsed time of a stage, and the amount of work done at its start.
struct StageTime {
  double elapsed_s = 0;
  size_t done_at_start = 0;
};

/// Returns the line for one report, at most `width` characters long. Rate and remaining time are shown once
/// they can be estimated.
std::string progress_line(const ProgressReport& now, const StageTime& time, size_t width);

}  // namespace kinloop
