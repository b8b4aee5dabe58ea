#pragma once
// The protocol by which any program can be a camera; docs/protocol.md describes it. In: a stream of bytes.
// Out: the camera and frames.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "drivers/stream/socket_file.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/images/color_image.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// A stream of bytes from standard input, or from the program that connects to a Unix socket.
class ByteStream {
 public:
  explicit ByteStream(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}

  /// Fills `buffer`, waiting for data; returns the number of bytes read, fewer at the end of the stream or if
  /// `stop` said so, which is asked ten times a second.
  size_t read(std::span<uint8_t> buffer, const StopRequest& stop) const;

 private:
  Descriptor descriptor_;
};

/// Standard input. Throws UsageError if it is a terminal.
ByteStream open_standard_input();

/// Creates a socket that only this user may connect to, waits for one connection and removes the socket.
/// Throws InputError if it cannot be created, as where another process listens, or if `stop` said so.
ByteStream accept_connection(const std::filesystem::path& path, const StopRequest& stop = {});

/// The first record of a stream.
struct StreamStart {
  std::optional<RgbdCamera> camera;
  bool live = true;  ///< frames that come too fast are dropped
};

/// An image as sent.
struct SentImage {
  std::string encoding;
  std::vector<uint8_t> data;
};

/// A frame as sent.
struct SentFrame {
  int64_t stamp_ns = 0;        ///< of colour
  int64_t depth_stamp_ns = 0;  ///< of depth
  SentImage color, depth;
  std::optional<SentImage> mask;
};

/// Reads the records of one stream. Every function throws InputError naming stream and record if the stream
/// does not follow the protocol or ends within a record.
class FrameProtocol {
 public:
  FrameProtocol(ByteStream bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {}

  /// Throws InputError also if `stop` said so.
  StreamStart read_start(const StopRequest& stop);

  /// Returns the next frame; nullopt at the end of the stream, or if `stop` said so.
  std::optional<SentFrame> read_frame(const StopRequest& stop);

 private:
  [[noreturn]] void reject(const std::string& what) const;
  std::optional<std::string> read_header(const StopRequest& stop);
  std::vector<uint8_t> read_data(uint64_t size, const StopRequest& stop) const;

  ByteStream bytes_;
  std::string name_;
  size_t record_ = 0;  ///< number of the current record, from 0
};

/// Decode the images of a frame: colour to 8UC3 BGR, depth to 32FC1 metres, a mask to 8UC1. Throw InputError
/// if the image is damaged, of another size than the camera's or in an unknown encoding.
ColorImage decode_sent_color(const SentImage& image, const PinholeCamera& camera);
cv::Mat decode_sent_depth(const SentImage& image, const PinholeCamera& camera, double depth_scale);
cv::Mat decode_sent_mask(const SentImage& image, const PinholeCamera& camera);

}  // namespace kinloop
