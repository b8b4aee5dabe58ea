#include <utility>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/core/time.hpp"
#include "tools/export/mcap/messages.hpp"

namespace kinloop::ros_messages {
namespace {

constexpr const char* kFrame = "camera_color_optical_frame";

constexpr const char* kHeader =
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

constexpr const char* kCompressedImage =
    "std_msgs/Header header\n"
    "string format\n"
    "uint8[] data\n";

constexpr const char* kCameraInfo =
    "std_msgs/Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "string distortion_model\n"
    "float64[] d\n"
    "float64[9] k\n"
    "float64[9] r\n"
    "float64[12] p\n"
    "uint32 binning_x\n"
    "uint32 binning_y\n"
    "sensor_msgs/RegionOfInterest roi\n"
    "================================================================================\n"
    "MSG: sensor_msgs/RegionOfInterest\n"
    "uint32 x_offset\n"
    "uint32 y_offset\n"
    "uint32 height\n"
    "uint32 width\n"
    "bool do_rectify\n";

McapTopic topic(const std::string& name, const char* type, const std::string& definition) {
  return {name, type, definition, "ros2msg", "cdr"};
}

/// Aligns each number to its size, counted from behind the four bytes that name the encoding.
class CdrWriter {
 public:
  template <class Number>
  CdrWriter& number(Number value) {
    while ((bytes_.size() - kEncapsulation) % sizeof(Number) != 0) bytes_ += '\0';
    put_values(bytes_, &value, 1);
    return *this;
  }
  CdrWriter& text(std::string_view value) {
    number(static_cast<uint32_t>(value.size() + 1));
    bytes_ += value;
    bytes_ += '\0';
    return *this;
  }
  CdrWriter& data(std::string_view value) {
    number(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  CdrWriter& header(int64_t stamp_ns) {
    const auto [seconds, nanoseconds] = split_stamp(stamp_ns);
    if (!std::in_range<int32_t>(seconds))
      throw InputError(fmt::format("a time of {} s, beyond 2038, cannot be written for ROS 2", seconds));
    return number(static_cast<int32_t>(seconds)).number(static_cast<uint32_t>(nanoseconds)).text(kFrame);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  static constexpr size_t kEncapsulation = 4;

  std::string bytes_{0, 1, 0, 0};  ///< CDR, little-endian
};

const char* distortion_model(LensModel model) {
  if (model == LensModel::kKannalaBrandt) return "equidistant";
  return model == LensModel::kRational ? "rational_polynomial" : "plumb_bob";
}

}  // namespace

McapTopic compressed_image_topic(const std::string& name) {
  return topic(name, "sensor_msgs/msg/CompressedImage", std::string(kCompressedImage) + kHeader);
}

McapTopic camera_info_topic(const std::string& name) {
  return topic(name, "sensor_msgs/msg/CameraInfo", std::string(kCameraInfo) + kHeader);
}

McapTopic string_topic(const std::string& name) {
  return topic(name, "std_msgs/msg/String", "string data\n");
}

std::string compressed_image(int64_t stamp_ns, std::string_view format, std::string_view data) {
  return CdrWriter().header(stamp_ns).text(format).data(data).bytes();
}

std::string camera_info(int64_t stamp_ns, const PinholeCamera& camera) {
  const PinholeCamera& c = camera;
  CdrWriter writer;
  writer.header(stamp_ns).number(static_cast<uint32_t>(c.height)).number(static_cast<uint32_t>(c.width));
  const std::vector<double> distortion = lens_coefficients(c.lens);
  writer.text(distortion_model(c.lens.model)).number(static_cast<uint32_t>(distortion.size()));
  for (const double d : distortion) writer.number(d);
  for (const double k : {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}) writer.number(k);
  for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) writer.number(r);
  for (const double p : {c.fx, 0.0, c.cx, 0.0, 0.0, c.fy, c.cy, 0.0, 0.0, 0.0, 1.0, 0.0}) writer.number(p);
  for (int i = 0; i < 6; ++i) writer.number(uint32_t{0});  // binning and region of interest
  return writer.number(uint8_t{0}).bytes();
}

std::string text(std::string_view value) {
  return CdrWriter().text(value).bytes();
}

}  // namespace kinloop::ros_messages
