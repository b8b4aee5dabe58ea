#pragma once
// Writes recordings of OpenNI (.oni), record by record.

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace kinloop::test {

constexpr double kOniView_rad = 1.0;

/// A stream of the recording.
struct OniWriterStream {
  uint32_t node = 1;
  int32_t type = 2;  ///< 2: depth, 3: colour
  std::string codec = "NONE";
  uint64_t pixels = 100;
  cv::Size size{32, 24};
  bool mirrored = false;
  double view_rad = kOniView_rad;  ///< 0: none is written
};

template <class Number>
std::string raw(Number number) {
  return {reinterpret_cast<const char*>(&number), sizeof(number)};
}

inline std::string counted(const std::string& text) {
  return raw(static_cast<uint32_t>(text.size())) + text;
}

inline std::string oni_record(uint32_t type, uint32_t node, const std::string& fields,
                              const std::string& payload = {}) {
  return raw(uint32_t{0x0052494E}) + raw(type) + raw(node) + raw(static_cast<uint32_t>(28 + fields.size())) +
         raw(static_cast<uint32_t>(payload.size())) + raw(uint64_t{0}) + fields + payload;
}

inline std::string oni_header(uint32_t nodes = 2) {
  return "NI10" + raw(uint8_t{1}) + raw(uint8_t{0}) + raw(uint16_t{1}) + raw(uint32_t{0}) + raw(UINT64_MAX) +
         raw(nodes);
}

inline std::string oni_integer(uint32_t node, const std::string& name, uint64_t value) {
  return oni_record(0x03, node, counted(name + '\0') + counted(raw(value)));
}

inline std::string oni_general(uint32_t node, const std::string& name, const std::string& value) {
  return oni_record(0x06, node, counted(name + '\0') + counted(value));
}

inline std::string oni_stream(const OniWriterStream& stream, uint32_t images) {
  const uint32_t node = stream.node;
  const auto width = static_cast<uint32_t>(stream.size.width),
             height = static_cast<uint32_t>(stream.size.height);
  std::string bytes =
      oni_record(0x0D, node,
                 counted((stream.type == 2 ? "Depth" : "Image") + std::string(1, '\0')) + raw(stream.type) +
                     stream.codec + raw(images) + raw(uint64_t{0}) + raw(UINT64_MAX) + raw(uint64_t{0}));
  bytes += oni_integer(node, "oniRequiredFrameSize", 3 * uint64_t{width} * height);
  if (stream.type == 2) bytes += oni_integer(node, "xnDeviceMaxDepth", 10'000);
  bytes += oni_general(node, "xnMapOutputMode", raw(width) + raw(height) + raw(uint32_t{30}));
  bytes += oni_integer(node, "oniPixelFormat", stream.pixels);
  if (stream.view_rad > 0)
    bytes += oni_general(node, "xnFOV", raw(stream.view_rad) + raw(0.75 * stream.view_rad));
  bytes += oni_general(node, "xnCropping", std::string(12, '\0'));
  if (stream.mirrored) bytes += oni_integer(node, "xnMirror", 1);
  return bytes + oni_record(0x09, node, "");
}

/// The beginning of the images of a stream.
inline std::string oni_data_begin(uint32_t node, uint32_t images) {
  return oni_record(0x08, node, raw(images) + raw(uint32_t{0}) + raw(UINT64_MAX));
}

inline std::string oni_image(uint32_t node, uint64_t stamp_us, uint32_t number, const std::string& data) {
  return oni_record(0x0A, node, raw(stamp_us) + raw(number), data);
}

inline std::string oni_end() {
  return oni_record(0x0B, 0, "");
}

}  // namespace kinloop::test
