#pragma once
// In: a folder or a file in any known layout. Out: its frames, or what was looked for.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "drivers/datasets/camera_selection.hpp"
#include "drivers/datasets/recorded_sequence.hpp"
#include "drivers/datasets/sequences_below.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// A recognised sequence and its camera.
struct OpenedSequence {
  RecordedSequence sequence;
  RgbdCamera camera;
  std::string name = {};  ///< as the user can give it again
};

/// Reads the lists, poses and calibration of a recorded sequence, see camera_of_sequence for the camera.
/// `name` chooses among the sequences below the path, see sequence_folder. Throws InputError with the remedy
/// if the path is in no known layout or has no camera.
OpenedSequence read_sequence(const std::filesystem::path& path,
                             const std::optional<CameraArgument>& camera_argument = {},
                             std::optional<double> depth_scale = {}, const std::string& name = {});

/// Same of a sequence that is located already.
OpenedSequence read_located(const LocatedSequence& located,
                            const std::optional<CameraArgument>& camera_argument = {},
                            std::optional<double> depth_scale = {});

/// Opens a sequence in any layout; `info().description` says which.
std::unique_ptr<FrameSource> open_sequence(const std::string& path,
                                           const std::optional<CameraArgument>& camera_argument = {},
                                           std::optional<double> depth_scale = {},
                                           const std::string& name = {});

}  // namespace kinloop
