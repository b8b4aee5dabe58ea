#pragma once
// The layouts of recorded sequences that kinloop reads: each a file with a function here, listed in the
// registry.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

struct SequenceLayout {
  const char* name;
  const char* looked_for;  ///< the files it is recognised by, for users

  /// Returns the file or folder by which the layout is recognised; empty if it is another one. Only names are
  /// examined. `path` may be a file, which has empty contents.
  std::string (*evidence)(const std::filesystem::path& path, const FolderContents& contents);

  /// Throws InputError naming the file and the remedy if files are missing or damaged.
  RecordedSequence (*read)(const std::filesystem::path& path);
};

/// All layouts, those with more evidence first.
std::span<const SequenceLayout> sequence_layouts();

/// Returns the layout of a folder or file; null if it has none of them.
const SequenceLayout* recognise_layout(const std::filesystem::path& path);

/// Reads the lists, and the ground truth, of a folder in TUM layout.
RecordedSequence read_tum(const std::filesystem::path& folder);

/// Returns the frame rate that camera.yaml in the folder states; 30 Hz if there is none.
double stated_fps(const std::filesystem::path& folder);

SequenceLayout tum_layout();
SequenceLayout eth3d_layout();
SequenceLayout bonn_layout();
SequenceLayout icl_nuim_layout();
SequenceLayout open_loris_layout();
SequenceLayout seven_scenes_layout();
SequenceLayout bundle_fusion_layout();
SequenceLayout scannet_layout();
SequenceLayout sens_layout();
SequenceLayout replica_layout();
SequenceLayout tartan_air_layout();
SequenceLayout stray_scanner_layout();
SequenceLayout scanner_3d_app_layout();
SequenceLayout polycam_layout();
SequenceLayout record3d_layout();
SequenceLayout record3d_export_layout();
SequenceLayout transforms_layout();
SequenceLayout redwood_layout();
SequenceLayout listed_layout();
SequenceLayout plain_layout();
SequenceLayout flat_layout();

}  // namespace kinloop
