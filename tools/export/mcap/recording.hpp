#pragma once
// Recordings of frames and of maps as MCAP files.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "tools/export/mcap/mcap_writer.hpp"

namespace kinloop {

// Frames as ROS 2 messages, from which kinloop reads back identical frames; see recording_format.hpp.

/// A compressed frame.
struct CompressedFrame {
  int64_t stamp_ns = 0;      ///< of colour
  std::string color, depth;  ///< messages
};

/// Compresses a frame: colour as the camera's JPEG or else PNG, depth as RVL of `depth_scale` units per
/// metre, unknown where it does not fit in 16 bits.
CompressedFrame compress_frame(const Frame& frame, double depth_scale);

class FrameRecording {
 public:
  /// Throws InputError if the file cannot be created.
  FrameRecording(const std::filesystem::path& path, const RgbdCamera& camera);

  /// Without `commit` (a full disk, an exception) the frames so far are kept, in a file without index; if its
  /// name is taken, in recovered-PID-N.mcap.
  ~FrameRecording();
  FrameRecording(const FrameRecording&) = delete;
  FrameRecording& operator=(const FrameRecording&) = delete;

  /// Writes the frame as a chunk of its own, so that a full disk takes no frame before it. Stamps must
  /// increase. Throws InputError if it cannot be written.
  void write(const CompressedFrame& frame);

  /// Completes the file and gives it its name. Throws InputError if another process has taken the name.
  void commit();

 private:
  RgbdCamera camera_;
  McapWriter file_;
  uint16_t color_, depth_, camera_yaml_, camera_info_;
  bool empty_ = true, complete_ = false;
};

// A map as a recording for Foxglove.

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
