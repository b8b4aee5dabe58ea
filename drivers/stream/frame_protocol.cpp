#include "drivers/stream/frame_protocol.hpp"

#include <map>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "drivers/images/encoded_image.hpp"
#include "drivers/images/mask_image.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop {
namespace {

using Json = nlohmann::json;

constexpr uint32_t kMaxHeaderBytes = 1U << 20;
constexpr uint64_t kMaxImageBytes = uint64_t{1} << 28;
constexpr int kProtocolVersion = 1;

Json parsed_json(const std::string& text) {
  Json value = parse_json(text);
  if (value.is_discarded()) throw InputError("the header is not JSON");
  return value;
}

/// Returns whether a value can be read as this type. nlohmann converts floats and booleans to integers, also
/// out of range.
template <class Value>
bool is_readable(const Json& value) {
  if constexpr (std::is_integral_v<Value>) {
    if (value.is_number_unsigned()) return std::in_range<Value>(value.get<uint64_t>());
    return value.is_number_integer() && std::in_range<Value>(value.get<int64_t>());
  }
  return true;
}

template <class Value>
Value field(const Json& header, const char* key, const char* expected) {
  try {
    if (is_readable<Value>(header.at(key))) return header.at(key).get<Value>();
  } catch (const Json::exception&) {  // reported below
  }
  throw InputError(fmt::format("the header has no \"{}\": {}", key, expected));
}

int64_t stamp_field(const Json& header, const char* key, const char* expected) {
  return checked_stamp_ns(field<int64_t>(header, key, expected));
}

/// The announcement of an image: its encoding, and its size in bytes.
struct AnnouncedImage {
  std::string encoding;
  uint64_t bytes = 0;
};

AnnouncedImage announced_image(const Json& header, const char* key) {
  constexpr const char* kExpected = "{\"encoding\": \"jpeg\", \"bytes\": 12345}";
  const Json image = field<Json>(header, key, kExpected);
  AnnouncedImage announced{printable(field<std::string>(image, "encoding", "the encoding of an image")),
                           field<uint64_t>(image, "bytes", "the size of an image")};
  if (announced.bytes > kMaxImageBytes)
    throw InputError(
        fmt::format("an image of {} bytes; at most {} are read", announced.bytes, kMaxImageBytes));
  return announced;
}

StreamStart start_of(const Json& header, const std::string& name) {
  const int version = field<int>(header, "kinloop", "1, the version of the protocol");
  if (version != kProtocolVersion)
    throw InputError(
        fmt::format("version {} of the protocol; this program reads version {}", version, kProtocolVersion));
  StreamStart start;
  start.live = header.value("live", true);
  if (header.contains("camera")) {
    const Json& camera = header["camera"];
    start.camera = read_camera_text(camera.is_string() ? camera.get<std::string>() : json_text(camera), name);
  }
  return start;
}

/// Returns the bytes of a pixel of a raw image; 0 for an unknown encoding.
size_t pixel_bytes(const std::string& encoding) {
  static const std::map<std::string, size_t> bytes = {
      {"mono8", 1}, {"8UC1", 1}, {"bgr8", 3},  {"rgb8", 3},   {"8UC3", 3},   {"bgra8", 4},
      {"rgba8", 4}, {"8UC4", 4}, {"uyvy", 2},  {"UYVY", 2},   {"yuv422", 2}, {"yuv422_yuy2", 2},
      {"yuyv", 2},  {"YUYV", 2}, {"16UC1", 2}, {"mono16", 2}, {"32FC1", 4}};
  const auto found = bytes.find(encoding);
  return found != bytes.end() ? found->second : 0;
}

/// Rows without padding. Throws InputError for any other number of bytes: the image is of another size, and
/// its rows would be sheared.
RosImage raw_image(const SentImage& image, const PinholeCamera& camera) {
  const size_t pixel = pixel_bytes(image.encoding), row = static_cast<size_t>(camera.width) * pixel;
  const size_t expected = row * static_cast<size_t>(camera.height);
  if (pixel != 0 && image.data.size() != expected) {
    throw InputError(fmt::format(
        "{} bytes of {}, where {} x {} pixels of {} bytes are {}; send rows without padding, of the size of "
        "the camera",
        image.data.size(), image.encoding, camera.width, camera.height, pixel, expected));
  }
  return {camera.width, camera.height, row, image.encoding, false, image.data};
}

void require_camera_size(const cv::Size& size, const PinholeCamera& camera) {
  if (size.width == camera.width && size.height == camera.height) return;
  throw InputError(fmt::format("{} x {} pixels where the camera has {} x {}", size.width, size.height,
                               camera.width, camera.height));
}

}  // namespace

void FrameProtocol::reject(const std::string& what) const {
  throw InputError(fmt::format("{}: record {}: {}; see docs/protocol.md", name_, record_, what));
}

std::optional<std::string> FrameProtocol::read_header(const StopRequest& stop) {
  std::array<uint8_t, sizeof(uint32_t)> prefix{};
  const size_t read = bytes_.read(prefix, stop);
  if (stop() || read == 0) return std::nullopt;
  if (read < prefix.size()) reject("the stream ends within the length of a header");
  const auto size = ByteReader(prefix).number<uint32_t>();
  if (size == 0 || size > kMaxHeaderBytes)
    reject(fmt::format("a header of {} bytes; expected its length in 4 bytes, little-endian, at most {}",
                       size, kMaxHeaderBytes));
  const auto data = read_data(size, stop);
  return std::string(as_text(data));
}

std::vector<uint8_t> FrameProtocol::read_data(uint64_t size, const StopRequest& stop) const {
  constexpr uint64_t kStep = uint64_t{1} << 22;  // memory grows with what has really arrived
  std::vector<uint8_t> data;
  while (data.size() < size) {
    const size_t start = data.size();
    data.resize(static_cast<size_t>(std::min(size, start + kStep)));
    const auto part = std::span(data).subspan(start);
    if (bytes_.read(part, stop) < part.size() && !stop()) reject("the stream ends within the record");
    if (stop()) break;
  }
  return data;
}

StreamStart FrameProtocol::read_start(const StopRequest& stop) {
  const auto header = read_header(stop);
  if (stop()) throw InputError(fmt::format("{}: stopped before its first record", name_));
  if (!header) reject("the stream is empty");
  try {
    return start_of(parsed_json(*header), name_);
  } catch (const InputError& error) {
    reject(error.what());
  } catch (const Json::exception&) {
    reject("the header has a value of the wrong kind");
  }
}

std::optional<SentFrame> FrameProtocol::read_frame(const StopRequest& stop) {
  ++record_;
  const auto text = read_header(stop);
  if (!text || stop()) return std::nullopt;
  SentFrame frame;
  AnnouncedImage color, depth;
  std::optional<AnnouncedImage> mask;
  try {
    const Json header = parsed_json(*text);
    frame.stamp_ns = stamp_field(header, "stamp_ns", "the time of the colour image, nanoseconds");
    frame.depth_stamp_ns =
        header.contains("depth_stamp_ns")
            ? stamp_field(header, "depth_stamp_ns", "the time of the depth image, nanoseconds")
            : frame.stamp_ns;
    color = announced_image(header, "color");
    depth = announced_image(header, "depth");
    if (header.contains("mask")) mask = announced_image(header, "mask");
  } catch (const InputError& error) {
    reject(error.what());
  }
  frame.color = {color.encoding, read_data(color.bytes, stop)};
  frame.depth = {depth.encoding, read_data(depth.bytes, stop)};
  if (mask) frame.mask = {mask->encoding, read_data(mask->bytes, stop)};
  if (stop()) return std::nullopt;
  return frame;
}

ColorImage decode_sent_color(const SentImage& image, const PinholeCamera& camera) {
  const bool compressed = image.encoding == "jpeg" || image.encoding == "png";
  if (const auto size = encoded_size(as_text(image.data)); compressed && size)
    require_camera_size(*size, camera);
  ColorImage color = compressed ? decode_embedded_color(image.data) : color_from(raw_image(image, camera));
  require_camera_size(color.size(), camera);
  return color;
}

cv::Mat decode_sent_depth(const SentImage& image, const PinholeCamera& camera, double depth_scale) {
  if (image.encoding != "png") return depth_from(raw_image(image, camera), 1 / depth_scale);
  if (const auto size = encoded_size(as_text(image.data))) require_camera_size(*size, camera);
  const cv::Mat units = decode_embedded_image(image.data);
  require_camera_size(units.size(), camera);
  if (units.type() != CV_16UC1) throw InputError("depth that is not a 16-bit grey PNG");
  return from_depth_units(units, depth_scale);
}

cv::Mat decode_sent_mask(const SentImage& image, const PinholeCamera& camera) {
  const cv::Size size(camera.width, camera.height);
  if (image.encoding == "png") return decode_mask(std::string(as_text(image.data)), size, "mask");
  if (image.encoding != "mono8")
    throw InputError(fmt::format("a mask of encoding '{}'; expected png or mono8", image.encoding));
  const auto expected = static_cast<size_t>(size.area());
  if (image.data.size() != expected)
    throw InputError(
        fmt::format("a mask of {} bytes where the camera has {} pixels", image.data.size(), expected));
  return cv::Mat(size, CV_8UC1, const_cast<uint8_t*>(image.data.data())) != 0;
}

}  // namespace kinloop
