#pragma once
// Records a Kinect 2's undecoded USB packets to a folder, via libfreenect2 (optional dependency).

#include <cstddef>
#include <filesystem>
#include <functional>

#include "drivers/live/kinect_options.hpp"

namespace kinloop {

/// Packet counts of a recording.
struct RawPacketCounts {
  size_t depth = 0, color = 0;
  size_t lost = 0;  ///< missing packet numbers
};

/// Writes TICKS_packet_NUMBER.depth (ten images of 11 bits per pixel) and .jpg for each packet, the tables
/// that depth decoding requires (p0_tables.bin, x_table.bin, z_table.bin, lookup_table.bin), the factory
/// parameters (parameters.yaml) and the cameras derived from them (camera.yaml), until `should_stop` or until
/// the camera is unplugged. Throws InputError if there is no camera or the folder is not writable, and
/// UsageError in a build without libfreenect2.
RawPacketCounts record_kinect2_raw(const KinectOptions& options, const std::filesystem::path& folder,
                                   const std::function<bool(const RawPacketCounts&)>& should_stop);

}  // namespace kinloop
