#include "drivers/image_files/fast_encoder.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/recording_format.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/sensor/images/depth_codec.hpp"
#include "tools/export/mcap/messages.hpp"
#include "tools/export/mcap/recording.hpp"

namespace kinloop {
namespace {

/// RVL as ROS has it: `pack_depth` with the nibbles of each 32-bit word in reverse order.
std::string rvl_of(const cv::Mat& units) {
  constexpr size_t kWordBytes = 4;
  std::vector<uint8_t> packed = pack_depth({units.ptr<uint16_t>(), units.total()});
  packed.resize((packed.size() + kWordBytes - 1) / kWordBytes * kWordBytes);
  std::string words(packed.size(), '\0');
  for (size_t i = 0; i < packed.size(); ++i) {
    const size_t reversed = i - i % kWordBytes + (kWordBytes - 1 - i % kWordBytes);
    words[reversed] = static_cast<char>(packed[i] << 4U | packed[i] >> 4U);
  }
  return words;
}

}  // namespace

CompressedFrame compress_frame(const Frame& frame, double depth_scale) {
  CompressedFrame recorded;
  recorded.stamp_ns = frame.stamp_ns;
  const std::string_view jpeg = frame.color.jpeg();
  recorded.color = jpeg.empty()
                       ? ros_messages::compressed_image(frame.stamp_ns, "png", encode_png(frame.color.bgr()))
                       : ros_messages::compressed_image(frame.stamp_ns, "jpeg", jpeg);
  const cv::Mat units = to_depth_units(frame.depth_m, depth_scale);
  const uint32_t size[] = {static_cast<uint32_t>(units.cols), static_cast<uint32_t>(units.rows)};
  std::string depth;
  put_values(depth, size, 2);
  depth += rvl_of(units);
  recorded.depth = ros_messages::compressed_image(frame.depth_stamp_or_color_ns(), "16UC1; rvl", depth);
  return recorded;
}

FrameRecording::FrameRecording(const std::filesystem::path& path, const RgbdCamera& camera)
    : camera_(camera),
      file_(path, {"ros2", false}),
      color_(file_.add_topic(ros_messages::compressed_image_topic(recording::kColorTopic))),
      depth_(file_.add_topic(ros_messages::compressed_image_topic(recording::kDepthTopic))),
      camera_yaml_(file_.add_topic(ros_messages::string_topic(recording::kCameraTopic))),
      camera_info_(file_.add_topic(ros_messages::camera_info_topic(recording::kCameraInfoTopic))) {}

FrameRecording::~FrameRecording() {
  if (!empty_ && !complete_) file_.keep_recording();
}

void FrameRecording::commit() {
  file_.commit(Existing::kKept);
  complete_ = true;
}

void FrameRecording::write(const CompressedFrame& frame) {
  const int64_t stamp_ns = frame.stamp_ns;
  if (empty_) {
    file_.write(camera_yaml_, stamp_ns, ros_messages::text(camera_file_text(camera_)));
    file_.write(camera_info_, stamp_ns, ros_messages::camera_info(stamp_ns, camera_.color));
  }
  file_.write(color_, stamp_ns, frame.color);
  file_.write(depth_, stamp_ns, frame.depth);
  file_.flush();
  empty_ = false;
}

}  // namespace kinloop
