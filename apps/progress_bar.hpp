#pragma once
// In: progress reports. Out: one line on standard error that is drawn over and over:
//
//   mapping    [============>             ]  512/1000   28.4/s   17 s left   tracking, 44 keyframes, 2 loops

#include <string>

#include "kinloop/base/progress.hpp"

namespace kinloop {

/// A progress bar on standard error, one line per stage; nothing is drawn when `quiet`, or where standard
/// error is not a terminal. The line is ended when the last copy goes. It never asks the work to stop.
Progress make_progress_bar(bool quiet = false);

/// The line for one report after `elapsed_s` in its stage, at most `width` characters long.
std::string progress_line(const ProgressReport& now, double elapsed_s, size_t width);

}  // namespace kinloop
