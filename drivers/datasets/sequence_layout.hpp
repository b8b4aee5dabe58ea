#pragma once
// In: a path that is not a sequence. Out: what it looks like, what was looked for and what to do. Only file
// names are examined, and images only for the template of a camera.

#include <filesystem>
#include <string>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Returns whether the list of frames exists: associations.txt, or rgb.txt and depth.txt.
bool has_tum_lists(const std::filesystem::path& folder);

/// Returns whether one of these lists exists: a sequence in TUM layout, perhaps not a complete one.
bool is_incomplete_tum(const FolderContents& contents);

/// Returns whether a run has written its results there.
bool is_run_folder(const FolderContents& contents);

/// Throws InputError for a path in no known layout. The message says what it looks like (the layout
/// of another dataset, a video, the results of a run, the parent folder of a sequence); the hint lists the
/// files by which layouts are recognised and, with a camera.yaml template unless `camera_known`, those of TUM
/// layout.
[[noreturn]] void reject_sequence(const std::filesystem::path& path, bool camera_known);

/// Throws InputError for a sequence without a camera, with a camera.yaml template made of its images. It says
/// which file is missing if the layout has one.
[[noreturn]] void reject_without_camera(const std::filesystem::path& path, const RecordedSequence& sequence);

}  // namespace kinloop
