#pragma once
// Folders of frame-000000.color.*, frame-000000.depth.* and frame-000000.pose.txt, which several datasets
// share.

#include <filesystem>
#include <string>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Returns the first colour image; empty if the folder has other files.
std::string frame_files_evidence(const FolderContents& contents);

/// Reads the frames and their poses; the poses of frames without tracking, which are infinite, are left out.
/// Stamps are made from 30 Hz. Throws InputError naming the file.
RecordedSequence read_frame_files(const std::filesystem::path& folder);

}  // namespace kinloop
