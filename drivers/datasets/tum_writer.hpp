#pragma once
// In: frames. Out: a folder in the layout of the TUM RGB-D benchmark from which `TumSource` reads back
// identical frames.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "kinloop/core/files/folder_lock.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Returns the names of the files, but for the images, that a sequence consists of.
std::vector<std::string> tum_file_names();

/// Throws InputError if `folder` already holds a sequence or is not writable.
void require_no_sequence(const std::filesystem::path& folder);

/// Writes a sequence. Each image is written atomically; `finish` writes the lists that complete the sequence
/// (rgb.txt, depth.txt, associations.txt).
class TumWriter {
 public:
  /// Creates the folder if needed, locks it and writes camera.yaml. Throws InputError if the folder holds a
  /// sequence or is not writable.
  TumWriter(std::filesystem::path folder, const RgbdCamera& camera);

  /// Adds a frame; its stamp must be later than the previous one. Colour is the camera's JPEG, or else PNG.
  /// Depth is rounded to the camera's units per metre; values out of the 16-bit range are written as unknown.
  void append(const Frame& frame);

  /// The two halves of `append`: the images alone, which several threads may write at once, and the lines of
  /// the lists.
  void write_images(const Frame& frame) const;
  void add_to_lists(const Frame& frame);

  /// Writes the lists, and groundtruth.txt unless `ground_truth` is empty.
  void finish(const Trajectory& ground_truth = {});

 private:
  std::filesystem::path folder_;
  std::unique_ptr<const FolderLock> lock_;
  double depth_scale_;
  int64_t newest_ns_;
  std::string color_list_, depth_list_, pair_list_;
};

}  // namespace kinloop
