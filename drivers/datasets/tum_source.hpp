#pragma once
// In: a folder in the layout of the TUM RGB-D benchmark (rgb.txt, depth.txt, optional associations.txt,
// groundtruth.txt and camera.yaml). Out: its frames.

#include <filesystem>

#include "drivers/datasets/recorded_source.hpp"

namespace kinloop {

class TumSource : public RecordedSource {
 public:
  /// Uses the camera that `choose_camera` finds for the folder.
  explicit TumSource(const std::filesystem::path& folder);

  /// Throws InputError naming file, line and remedy if the sequence is unusable: nothing to read, images of
  /// another size than the camera's, or an invalid ground truth.
  TumSource(const std::filesystem::path& folder, const RgbdCamera& camera);
};

}  // namespace kinloop
