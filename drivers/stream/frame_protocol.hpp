#pragma once
// The protocol by which any program can be a camera; docs/protocol.md describes it. In: a stream of bytes.
// Out: the camera and frames.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "drivers/stream/byte_stream.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/images/color_image.hpp"

namespace kinloop {

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
