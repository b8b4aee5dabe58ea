#pragma once

#include "kinloop/output/run_folder.hpp"

namespace kinloop {

/// Makes report.html from the other files in a run's folder. Throws InputError when one that it needs is
/// missing or damaged; keyframes, ground truth and map may be missing.
void write_report(const RunFolder& folder);

}  // namespace kinloop
