#pragma once
// ROS messages as bytes: ROS 1, or CDR in either byte order.

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop::test {

enum class Serialization { kRos1, kCdrLittle, kCdrBig };

/// Appends fields with the padding and byte order of the serialisation.
class MessageWriter {
 public:
  explicit MessageWriter(Serialization kind) : kind_(kind) {
    if (kind == Serialization::kRos1) return;
    bytes_ = {0, static_cast<char>(kind == Serialization::kCdrLittle ? 1 : 0), 0, 0};
  }

  template <class Number>
  MessageWriter& number(Number value) {
    if (kind_ != Serialization::kRos1) {
      while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_ += '\0';
    }
    if (kind_ == Serialization::kCdrBig) value = byte_swapped(value);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  MessageWriter& text(const std::string& value) {
    const bool terminated = kind_ != Serialization::kRos1;
    number(static_cast<uint32_t>(value.size() + (terminated ? 1 : 0)));
    bytes_ += value;
    if (terminated) bytes_ += '\0';
    return *this;
  }
  MessageWriter& data(std::string_view value) {
    number(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  MessageWriter& header(int64_t stamp_ns, const std::string& frame) {
    if (kind_ == Serialization::kRos1) number(uint32_t{0});
    number(static_cast<uint32_t>(stamp_ns / 1'000'000'000))
        .number(static_cast<uint32_t>(stamp_ns % 1'000'000'000));
    return text(frame);
  }
  MessageWriter& transform(const SE3& T) {
    for (int i = 0; i < 3; ++i) number(T.translation[i]);
    for (int i = 0; i < 4; ++i) number(T.rotation.coeffs()[i]);
    return *this;
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Serialization kind_;
  std::string bytes_;
};

inline std::string pixels_of(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

/// sensor_msgs/Image.
inline std::string image_message(Serialization kind, int64_t stamp_ns, const cv::Mat& image,
                                 const std::string& encoding, const std::string& frame = "color") {
  MessageWriter writer(kind);
  writer.header(stamp_ns, frame)
      .number(static_cast<uint32_t>(image.rows))
      .number(static_cast<uint32_t>(image.cols));
  writer.text(encoding)
      .number(uint8_t{0})
      .number(static_cast<uint32_t>(image.cols * static_cast<int>(image.elemSize())));
  return writer.data(pixels_of(image)).bytes();
}

/// sensor_msgs/CompressedImage.
inline std::string compressed_message(Serialization kind, int64_t stamp_ns, const std::string& format,
                                      std::string_view data, const std::string& frame = "color") {
  return MessageWriter(kind).header(stamp_ns, frame).text(format).data(data).bytes();
}

/// sensor_msgs/CameraInfo with any distortion.
inline std::string info_message(Serialization kind, const PinholeCamera& c, const std::string& model,
                                const std::vector<double>& distortion, const std::string& frame) {
  MessageWriter writer(kind);
  writer.header(1, frame)
      .number(static_cast<uint32_t>(c.height))
      .number(static_cast<uint32_t>(c.width))
      .text(model);
  writer.number(static_cast<uint32_t>(distortion.size()));
  for (const double d : distortion) writer.number(d);
  for (const double k : {c.fx, 0., c.cx, 0., c.fy, c.cy, 0., 0., 1.}) writer.number(k);
  for (const double r : {1., 0., 0., 0., 1., 0., 0., 0., 1.}) writer.number(r);
  for (const double p : {c.fx, 0., c.cx, 0., 0., c.fy, c.cy, 0., 0., 0., 1., 0.}) writer.number(p);
  for (int i = 0; i < 6; ++i) writer.number(uint32_t{0});
  return writer.number(uint8_t{0}).bytes();
}

inline std::string info_message(Serialization kind, const PinholeCamera& c,
                                const std::string& model = "plumb_bob") {
  return info_message(kind, c, model, lens_coefficients(c.lens), "color");
}

/// tf2_msgs/TFMessage with one transform.
inline std::string transform_message(Serialization kind, const std::string& parent, const std::string& child,
                                     const SE3& T_parent_child) {
  MessageWriter writer(kind);
  writer.number(uint32_t{1}).header(1, parent).text(child);
  return writer.transform(T_parent_child).bytes();
}

}  // namespace kinloop::test
