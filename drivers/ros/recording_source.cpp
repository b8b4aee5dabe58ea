#include "drivers/ros/recording_source.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "drivers/image_files/image_file.hpp"
#include "drivers/images/encoded_image.hpp"
#include "drivers/images/first_reason.hpp"
#include "drivers/recording_format.hpp"
#include "drivers/ros/messages/ros_serialization.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop {
namespace {

class RecordingSource : public FrameSource {
 public:
  RecordingSource(std::unique_ptr<MessageFile> file, const std::filesystem::path& path,
                  const std::optional<RgbdCamera>& camera)
      : file_(std::move(file)) {
    info_.name = path.string();
    const RgbdCamera recorded = read_camera(path);
    camera_ = camera.value_or(recorded);
    camera_.depth_scale = recorded.depth_scale;
    camera_.depth.reset();  // registered when it was recorded
    if (camera && camera->depth_scale != recorded.depth_scale)
      log::info(
          "{}: depth is in units of {:g} per metre, as recorded; the depth_scale of --camera is not used",
          info_.name, recorded.depth_scale);
    if (camera && camera->depth_shift_m != 0)
      log::warn("{}: the depth_shift_m of --camera is not used: depth was corrected when it was recorded",
                info_.name);
    camera_.depth_shift_m = recorded.depth_shift_m;
    for (const BagTopic* topic : file_->topics()) {
      if (topic->name == recording::kColorTopic) info_.frames = topic->messages;
    }
    file_->select({recording::kColorTopic, recording::kDepthTopic});
  }

  std::optional<Frame> next() override {
    while (const auto message = file_->next()) {
      try {
        if (auto frame = completed_by(*message)) return frame;
      } catch (const InputError& error) {
        skipped_.add({message->topic->name, error.what()});
        color_.reset();
      }
    }
    if (given_ > 0) return std::nullopt;
    throw InputError(fmt::format("{}: no usable frame{}", info_.name, first_reason(skipped())));
  }

  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override {
    auto all = skipped_;
    const auto damage = file_->damage();
    all.add(damage);
    return all;
  }

 private:
  /// A colour image that waits for its depth.
  struct Color {
    int64_t log_ns = 0, stamp_ns = 0;
    ColorImage image;
  };

  RgbdCamera read_camera(const std::filesystem::path& path) {
    file_->select({recording::kCameraTopic});
    const auto message = file_->next();
    if (!message) throw InputError(fmt::format("{}: no camera; it is damaged, record again", path.string()));
    const Bytes text = RosReader(message->data, message->topic->encoding).bytes();
    const bool terminated = !text.empty() && text.back() == 0;
    return read_camera_text(std::string(as_text(terminated ? text.first(text.size() - 1) : text)), path);
  }

  /// The frame whose second image this is.
  std::optional<Frame> completed_by(const BagMessage& message) {
    const auto image = read_compressed_image({message.data, message.topic->encoding});
    if (message.topic->name == recording::kColorTopic) {
      color_ = Color{message.log_ns, image.header.stamp_ns, decode_embedded_color(image.data)};
      require_size(color_->image.size());
      return std::nullopt;
    }
    if (!color_ || color_->log_ns != message.log_ns) return std::nullopt;  // colour was damaged
    ByteReader reader(image.data);
    const auto width = reader.number<uint32_t>(), height = reader.number<uint32_t>();
    require_size({static_cast<int>(width), static_cast<int>(height)});
    const cv::Mat units =
        decode_rvl(reader.block(reader.left()), {camera_.color.width, camera_.color.height});
    Frame frame{FrameId{given_++},
                color_->stamp_ns,
                std::move(color_->image),
                from_depth_units(units, camera_.depth_scale),
                {},
                image.header.stamp_ns};
    color_.reset();
    return frame;
  }

  void require_size(const cv::Size& size) const {
    if (size == cv::Size(camera_.color.width, camera_.color.height)) return;
    throw InputError(fmt::format("{} x {} pixels where the camera has {} x {}", size.width, size.height,
                                 camera_.color.width, camera_.color.height));
  }

  std::unique_ptr<MessageFile> file_;
  SourceInfo info_;
  RgbdCamera camera_;
  std::optional<Color> color_;
  uint32_t given_ = 0;
  SkippedFrames skipped_;
};

}  // namespace

bool is_own_recording(const MessageFile& file) {
  const auto topics = file.topics();
  return std::any_of(topics.begin(), topics.end(),
                     [](const BagTopic* topic) { return topic->name == recording::kCameraTopic; });
}

std::unique_ptr<FrameSource> open_own_recording(std::unique_ptr<MessageFile> file,
                                                const std::filesystem::path& path,
                                                const std::optional<RgbdCamera>& camera) {
  return std::make_unique<RecordingSource>(std::move(file), path, camera);
}

}  // namespace kinloop
