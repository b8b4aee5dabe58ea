#pragma once
// In: a path that a user gave for a sequence in TUM layout, and that is none. Out: what it looks like, what
// is missing and what to do. Nothing but names of files is looked at.

#include <filesystem>

namespace kinloop {

/// Whether a list of frames is there: associations.txt, or rgb.txt and depth.txt.
bool has_tum_lists(const std::filesystem::path& folder);

/// Throws InputError for a path that cannot be read as a sequence in TUM layout: what it looks like (the
/// layout of another data set, a video, a run's results, the folder above a sequence) and, as a hint, all
/// files that are missing, with a camera.yaml to copy where `camera_known` is false.
[[noreturn]] void reject_sequence(const std::filesystem::path& path, bool camera_known);

}  // namespace kinloop
