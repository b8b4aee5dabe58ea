#pragma once
// In: a Kinect 2's packets as they come over USB. Out: a file for each, named as libfreenect2's replay device
// reads them. Needs libfreenect2's headers: for the Kinect 2's own files and their tests only.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include <libfreenect2/frame_listener.hpp>

#include "drivers/kinect2/kinect2_device.hpp"
#include "drivers/kinect2/kinect2_raw.hpp"

namespace kinloop {

/// Writes what libfreenect2's dump pipeline gives: TICKS_packet_NUMBER.depth and .jpg. Packets that it had to
/// skip are known by their numbers.
class Kinect2PacketWriter : public libfreenect2::FrameListener {
 public:
  /// Makes the folder. Throws InputError where that cannot be.
  explicit Kinect2PacketWriter(std::filesystem::path folder);

  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override;

  /// What was written so far. Throws InputError where a file could not be written.
  [[nodiscard]] RawPacketCounts written() const;

 private:
  void write(const libfreenect2::Frame& frame, const char* ending);
  void count(size_t& packets, std::optional<uint32_t>& last, uint32_t number);

  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  RawPacketCounts written_;
  std::optional<uint32_t> last_depth_, last_color_;
  std::string error_;  ///< the first; an exception must not go through libfreenect2
};

/// Records this device until `should_stop`, or until it gives nothing more for a second.
RawPacketCounts record_packets(Kinect2Handle handle, const KinectOptions& options,
                               const std::filesystem::path& folder,
                               const std::function<bool(const RawPacketCounts&)>& should_stop);

}  // namespace kinloop
