#pragma once
// In: frames. Out: one MCAP file of ROS 2 messages, from which kinloop reads back identical frames; see
// recording_format.hpp.

#include <cstdint>
#include <filesystem>
#include <string>

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "tools/export/mcap/mcap_writer.hpp"

namespace kinloop {

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

  /// Stamps must increase.
  void write(const CompressedFrame& frame);

  /// Completes the file and gives it its name. Throws InputError if another process has taken the name.
  void commit();

 private:
  RgbdCamera camera_;
  McapWriter file_;
  uint16_t color_, depth_, camera_yaml_, camera_info_;
  bool empty_ = true, complete_ = false;
};

}  // namespace kinloop
