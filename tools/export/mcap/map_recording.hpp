#pragma once
// A map as a recording for Foxglove.

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// A stored image and its time.
struct StampedImage {
  int64_t stamp_ns = 0;
  size_t image = 0;
};

struct MapRecording {
  Trajectory trajectory;             ///< in the world frame
  std::vector<StampedImage> images;  ///< in order of time
  ColoredCloud cloud;                ///< in the world frame
  PinholeCamera camera;              ///< of the images
  FileFrame frame;                   ///< of the written poses and the cloud
};

/// Returns the JPEG file of a stored image.
using JpegLoader = std::function<std::vector<uint8_t>(size_t image)>;

/// Writes an MCAP file atomically, with the messages in order of time: /tf (frame "camera" in "map"), /pose,
/// /camera/image and /camera/calibration of the images, and /cloud at the first stamp. Non-finite poses and
/// points are left out. Throws InputError on failure.
void write_map_recording(const std::filesystem::path& path, const MapRecording& recording,
                         const JpegLoader& load_jpeg);

}  // namespace kinloop
