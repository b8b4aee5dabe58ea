#pragma once
// A Kinect 2's packets as they come over USB, undecoded, into a folder. Only where the build found
// libfreenect2.

#include <cstddef>
#include <filesystem>
#include <functional>

#include "drivers/live/kinect_options.hpp"

namespace kinloop {

/// Packets of a recording.
struct RawPacketCounts {
  size_t depth = 0, color = 0;
  size_t lost = 0;  ///< numbers that were left out
};

/// Writes TICKS_packet_NUMBER.depth (ten images of 11 bits a pixel) and .jpg for each packet, what depth is
/// decoded with (p0_tables.bin, x_table.bin, z_table.bin, lookup_table.bin), the factory's parameters
/// (parameters.yaml) and the cameras made of them (camera.yaml), until `should_stop` or the camera is gone.
/// Throws InputError where there is no camera or the folder cannot be written, and UsageError in a build
/// without libfreenect2.
RawPacketCounts record_kinect2_raw(const KinectOptions& options, const std::filesystem::path& folder,
                                   const std::function<bool(const RawPacketCounts&)>& should_stop);

}  // namespace kinloop
