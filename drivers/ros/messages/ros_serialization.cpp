#include "drivers/ros/messages/ros_serialization.hpp"

#include <limits>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

constexpr size_t kCdrHeaderBytes = 4;

int size_px(uint32_t size) {
  constexpr uint32_t kMaxSide = 1U << 15;
  if (size > kMaxSide) throw InputError(fmt::format("an image of {} pixels a side: damaged", size));
  return static_cast<int>(size);
}

template <size_t kCount>
std::array<double, kCount> read_numbers(RosReader& reader) {
  std::array<double, kCount> numbers{};
  for (double& number : numbers) number = reader.number<double>();
  return numbers;
}

}  // namespace

RosReader::RosReader(Bytes message, std::string_view encoding)
    : message_(message), reader_(message), cdr_(encoding == "cdr") {
  if (encoding == "ros1") return;
  if (!cdr_) throw InputError(fmt::format("messages in the encoding '{}'; expected cdr or ros1", encoding));
  // RTPS 2.5, section 10.2: the representation, big-endian, then options. Odd ones are little-endian.
  const Bytes header = reader_.block(kCdrHeaderBytes);
  constexpr uint8_t kPlainCdr = 1, kPlainCdr2 = 7;
  const uint8_t kind = header[1] | 1U;
  if (header[0] != 0 || (kind != kPlainCdr && kind != kPlainCdr2))
    throw InputError(
        fmt::format("a message in the CDR representation {:#04x}; only plain CDR is read", header[1]));
  if (kind == kPlainCdr2) max_alignment_ = 4;
  const bool little = (header[1] & 1U) != 0;
  swapped_ = !little;  // ByteReader reads little-endian
}

void RosReader::align(size_t size) {
  if (!cdr_) return;
  const size_t alignment = std::min(size, max_alignment_);
  const size_t position = message_.size() - kCdrHeaderBytes - reader_.left();
  reader_.block((alignment - position % alignment) % alignment);
}

std::string RosReader::string() {
  const Bytes text = bytes();
  const bool terminated = cdr_ && !text.empty() && text.back() == 0;
  return printable(as_text(terminated ? text.first(text.size() - 1) : text));
}

Bytes RosReader::bytes() {
  return reader_.block(number<uint32_t>());
}

RosHeader RosReader::header() {
  if (!cdr_) number<uint32_t>();  // sequence number
  RosHeader header;
  const auto seconds = cdr_ ? int64_t{number<int32_t>()} : int64_t{number<uint32_t>()};
  header.stamp_ns = checked_stamp_ns(seconds * kNsPerSecond + number<uint32_t>());
  header.frame_id = string();
  return header;
}

StampedImage read_image(RosReader reader) {
  StampedImage message;
  message.header = reader.header();
  RosImage& image = message.image;
  image.height = size_px(reader.number<uint32_t>());
  image.width = size_px(reader.number<uint32_t>());
  image.encoding = reader.string();
  image.big_endian = reader.number<uint8_t>() != 0;
  image.step = reader.number<uint32_t>();
  image.data = reader.bytes();
  message.after = reader.rest();
  return message;
}

StampedCompressedImage read_compressed_image(RosReader reader) {
  StampedCompressedImage message;
  message.header = reader.header();
  message.format = reader.string();
  message.data = reader.bytes();
  return message;
}

StampedCameraInfo read_camera_info(RosReader reader) {
  constexpr uint32_t kMaxCoefficients = 14;
  StampedCameraInfo message;
  message.header = reader.header();
  RosCameraInfo& info = message.info;
  info.height = size_px(reader.number<uint32_t>());
  info.width = size_px(reader.number<uint32_t>());
  info.distortion_model = reader.string();
  const auto coefficients = reader.number<uint32_t>();
  if (coefficients > kMaxCoefficients)
    throw InputError(
        fmt::format("a camera_info message with {} distortion coefficients: damaged", coefficients));
  for (uint32_t i = 0; i < coefficients; ++i) info.D.push_back(reader.number<double>());
  info.K = read_numbers<9>(reader);
  read_numbers<9>(reader);  // rectifying rotation
  info.P = read_numbers<12>(reader);
  return message;
}

SE3 read_transform(RosReader& reader) {
  const auto t = read_numbers<3>(reader);
  const auto q = read_numbers<4>(reader);
  SE3 transform{Eigen::Quaterniond(q[3], q[0], q[1], q[2]), Eigen::Vector3d(t[0], t[1], t[2])};
  constexpr double kMinNorm = 0.5;
  if (!transform.is_finite() || transform.rotation.norm() < kMinNorm)
    throw InputError("a transform that is not a rigid motion");
  transform.rotation.normalize();
  return transform;
}

std::vector<StampedTransform> read_transforms(RosReader reader) {
  std::vector<StampedTransform> transforms;
  const auto count = reader.number<uint32_t>();
  for (uint32_t i = 0; i < count; ++i) {
    StampedTransform& transform = transforms.emplace_back();
    transform.header = reader.header();
    transform.child = reader.string();
    transform.T_parent_child = read_transform(reader);
  }
  return transforms;
}

}  // namespace kinloop
