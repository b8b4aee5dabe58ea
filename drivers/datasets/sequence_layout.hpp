#pragma once
// In: a path given as a TUM sequence that is not one. Out: what it looks like, what is missing and what to
// do. Only file names are examined.

#include <filesystem>

namespace kinloop {

/// Returns whether the list of frames exists: associations.txt, or rgb.txt and depth.txt.
bool has_tum_lists(const std::filesystem::path& folder);

/// Throws InputError for a path that is not a TUM sequence. The message says what it looks like (the layout
/// of another dataset, a video, the results of a run, the parent folder of a sequence); the hint lists all
/// missing files, with a camera.yaml template unless `camera_known`.
[[noreturn]] void reject_sequence(const std::filesystem::path& path, bool camera_known);

}  // namespace kinloop
