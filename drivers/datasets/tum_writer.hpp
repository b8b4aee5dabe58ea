#pragma once
// In: frames, one after the other. Out: a folder in the layout of the TUM RGB-D benchmark that `TumSource`
// reads back as the very same frames.

#include <cstdint>
#include <filesystem>
#include <string>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"

namespace kinloop {

/// Throws InputError where `folder` holds a sequence already, or cannot be written into.
void require_no_sequence(const std::filesystem::path& folder);

/// Writes a sequence. The images come one by one, each complete under its name; the lists that make a
/// sequence of them (rgb.txt, depth.txt, associations.txt) only with `finish`.
class TumWriter {
 public:
  /// Makes the folder where needed, takes away the lists of an older sequence in it and writes camera.yaml.
  /// Throws InputError when the folder cannot be written.
  TumWriter(std::filesystem::path folder, const RgbdCamera& camera);

  /// Adds a frame; its stamp must be later than that of the frame before. Depth is rounded to the camera's
  /// units per metre; what does not fit into 16 bits is written as unknown.
  void append(const RgbdFrame& frame, int64_t depth_stamp_ns);
  void append(const RgbdFrame& frame) { append(frame, frame.stamp_ns); }

  /// The two halves of `append`: the images alone, which several threads may do at once, and the lists'
  /// lines.
  void write_images(const RgbdFrame& frame, int64_t depth_stamp_ns) const;
  void add_to_lists(int64_t stamp_ns, int64_t depth_stamp_ns);

  /// Writes the lists, and groundtruth.txt where there is a ground truth.
  void finish(const Trajectory& ground_truth = {});

 private:
  std::filesystem::path folder_;
  double depth_scale_;
  int64_t newest_ns_;
  std::string color_list_, depth_list_, pair_list_;
};

}  // namespace kinloop
