#pragma once
// In: an opened map. Out: a recording for Rerun, written by Rerun's Python package.

#include <filesystem>

#include "session/store/rerun_parts.hpp"

namespace kinloop {

/// Throws InputError that says how to install it unless Rerun's Python package is there.
void require_rerun();

/// Writes FILE.rrd, atomically. Throws InputError on failure.
void export_rerun(const std::filesystem::path& file, const RerunRequest& request, const FileCloud& cloud,
                  OpenMap& open, const Progress& progress);

}  // namespace kinloop
