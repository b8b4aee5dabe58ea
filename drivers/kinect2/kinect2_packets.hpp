#pragma once
// In: a Kinect 2's raw USB packets. Out: one file per packet, named as libfreenect2's replay device expects.
// Requires libfreenect2's headers; internal to the Kinect 2 driver and its tests.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include <libfreenect2/frame_listener.hpp>

#include "drivers/kinect2/kinect2_device.hpp"
#include "drivers/kinect2/kinect2_raw.hpp"

namespace kinloop {

/// Writes the output of libfreenect2's dump pipeline: TICKS_packet_NUMBER.depth and .jpg. Gaps in the numbers
/// reveal dropped packets.
class Kinect2PacketWriter : public libfreenect2::FrameListener {
 public:
  /// Creates the folder. Throws InputError on failure.
  explicit Kinect2PacketWriter(std::filesystem::path folder);

  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override;

  /// Returns the counts so far. Throws InputError if a file could not be written.
  [[nodiscard]] RawPacketCounts written() const;

 private:
  void write(const libfreenect2::Frame& frame, const char* ending);
  void count(size_t& packets, std::optional<uint32_t>& last, uint32_t number);

  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  RawPacketCounts written_;
  std::optional<uint32_t> last_depth_, last_color_;
  std::string error_;  ///< first error; exceptions must not propagate through libfreenect2
};

/// Records this device until `should_stop`, or until it sends nothing for a second.
RawPacketCounts record_packets(Kinect2Handle handle, const KinectOptions& options,
                               const std::filesystem::path& folder,
                               const std::function<bool(const RawPacketCounts&)>& should_stop);

}  // namespace kinloop
