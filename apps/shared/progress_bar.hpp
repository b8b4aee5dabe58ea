#pragma once
// In: progress reports. Out: one line on standard error that is drawn over and over:
//
//   mapping    [============>             ]  512/1000   28.4/s   17 s left   tracking, 44 keyframes, 2 loops
//
// and where standard error is a file or a pipe, a line of its own now and then.

#include <string>

#include "kinloop/base/progress.hpp"

namespace kinloop {

/// A progress bar on standard error, one line per stage; where that is no terminal, a line every few seconds
/// of a stage that takes longer. Nothing is said when `quiet`. The line is ended when the last copy goes. It
/// never asks the work to stop.
Progress make_progress_bar(bool quiet = false);

/// How long a stage has taken, and what was done when its time began.
struct StageTime {
  double elapsed_s = 0;
  size_t done_at_start = 0;
};

/// The line for one report, at most `width` characters long. Rate and time left come when there is something
/// to reckon them from.
std::string progress_line(const ProgressReport& now, const StageTime& time, size_t width);

}  // namespace kinloop
