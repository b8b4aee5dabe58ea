#include "drivers/ros/bag_source.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/bags/bag_files.hpp"
#include "drivers/images/first_reason.hpp"
#include "drivers/live/frame_pairer.hpp"
#include "drivers/ros/bag_camera.hpp"
#include "drivers/ros/messages/ros_serialization.hpp"
#include "drivers/ros/realsense_bag.hpp"
#include "drivers/ros/recording_source.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

constexpr const char* kNoPartner = "no image of the other camera within 0.02 s";

std::set<std::string> names_of(const std::vector<const BagTopic*>& topics) {
  std::set<std::string> names;
  for (const BagTopic* topic : topics) names.insert(topic->name);
  return names;
}

std::optional<double> stated_depth_scale(const BagRequest& request) {
  if (request.depth_scale) return request.depth_scale;
  if (request.camera && request.camera_has_depth_scale) return request.camera->depth_scale;
  return std::nullopt;
}

class BagSource : public FrameSource {
 public:
  BagSource(std::unique_ptr<MessageFile> file, const BagRequest& request)
      : file_(std::move(file)), stated_scale_(stated_depth_scale(request)) {
    const std::optional<RgbdCamera>& camera = request.camera;
    const std::optional<std::string>& topics = request.topics;
    info_.name = request.path.string();
    const auto names = names_of(file_->topics());
    if (names.empty()) throw InputError(fmt::format("{}: no topic{}", info_.name, first_reason(skipped())));
    const auto of_sdk = topics ? std::nullopt : realsense_streams(names, info_.name);
    streams_ = of_sdk ? *of_sdk : choose_streams(names, topics, info_.name);
    if (camera) camera_ = *camera;
    if (of_sdk) {
      use_realsense(camera.has_value());
    } else if (!camera) {
      camera_ = read_bag_camera(*file_, streams_, info_.name);
    }
    set_depth_scale();
    require_possible(camera_, info_.name);
    preparation_.emplace(camera_);
    info_.frames = messages_of(streams_.color);
    for (const std::string& topic : {streams_.color, streams_.depth}) {
      if (is_zero_a_time(topic)) times_from_zero_.insert(topic);
    }
    file_->select({streams_.color, streams_.depth});
  }

  std::optional<Frame> next() override {
    while (true) {
      if (auto frame = pairer_.next()) {
        ++given_;
        return with_registered_depth(std::move(*frame));
      }
      if (finished_) break;
      read_message();
    }
    if (given_ == 0)
      throw InputError(fmt::format("{}: no usable frame{}", info_.name, first_reason(skipped())));
    return std::nullopt;
  }

  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override {
    auto all = skipped_;
    const auto damage = file_->damage();
    all.add(damage);
    if (!is_one_faster()) all.add({"image", kNoPartner}, pairer_.unpaired());
    all.add({"image", "its timestamp does not increase"}, pairer_.out_of_order());
    return all;
  }

 private:
  void use_realsense(bool has_camera) {
    of_sdk_ = true;
    stamps_of_sdk_ = read_realsense_stamps(*file_, streams_);
    const auto set_sensor = [this] { camera_.sensor.set_by_source(DepthSensorModel::kRealsenseD4xx); };
    if (has_camera) return set_sensor();
    const auto calibration = read_realsense_calibration(*file_, streams_, info_.name);
    camera_ = calibration.camera;
    set_sensor();
    depth_unit_m_ = calibration.depth_unit_m;
  }

  /// The camera states the unit of 16-bit depth; depth in metres is kept in the unit of the camera.
  void set_depth_scale() {
    camera_.has_metric_depth = !has_16_bit_depth();
    if (stated_scale_) {
      camera_.depth_scale = *stated_scale_;
    } else if (!camera_.has_metric_depth) {
      camera_.depth_scale = 1 / depth_unit_m_;
    }
  }

  /// Whether the first depth image has 16 bits per pixel.
  [[nodiscard]] bool has_16_bit_depth() {
    file_->select({streams_.depth});
    try {
      const auto message = file_->next();
      if (!message) return false;
      const RosReader reader(message->data, message->topic->encoding);
      if (message->topic->type == "sensor_msgs/CompressedImage")
        return !read_compressed_image(reader).format.starts_with("32FC1");
      return read_image(reader).image.encoding != "32FC1";
    } catch (const InputError&) {
      return false;  // said when it is read as a frame
    }
  }

  /// Returns the unit of 16-bit depth that the bag states as `unit_m`, or that the user gives instead.
  [[nodiscard]] double chosen_unit_m(double unit_m) {
    if (!stated_scale_) return unit_m;
    constexpr double kTolerance = 1e-3;
    const double by_bag = 1 / unit_m;
    if (std::abs(*stated_scale_ / by_bag - 1) > kTolerance && !std::exchange(told_unit_, true)) {
      log::warn("{}: depth is read with {:g} units per metre, as given; the bag itself would have {:g}",
                info_.name, *stated_scale_, by_bag);
    }
    return 1 / *stated_scale_;
  }

  /// Passes the next message to the pairer, or detects the end.
  void read_message() {
    const auto message = file_->next();
    if (!message) {
      finished_ = true;
      pairer_.finish();
      if (is_one_faster() && pairer_.unpaired() > 0)
        log::info("{}: {} images not used: {}; {} has {} images, {} has {}", info_.name, pairer_.unpaired(),
                  kNoPartner, streams_.color, messages_of(streams_.color), streams_.depth,
                  messages_of(streams_.depth));
      return;
    }
    try {
      add(*message);
    } catch (const InputError& error) {
      skipped_.add({message->topic->name, error.what()});
    }
  }

  void add(const BagMessage& message) {
    const BagTopic& topic = *message.topic;
    const RosReader reader(message.data, topic.encoding);
    const bool is_color = topic.name == streams_.color;
    if (topic.type == "sensor_msgs/Image") {
      const StampedImage m = read_image(reader);
      const int64_t stamp_ns = stamp_of(m.header, message);
      if (is_color) return add_color(stamp_ns, color_from(m.image));
      return add_depth(stamp_ns, depth_from(m.image, depth_unit_m(m)));
    }
    if (topic.type != "sensor_msgs/CompressedImage")
      throw InputError(fmt::format("expected an image message, found type {}", topic.type));
    const StampedCompressedImage m = read_compressed_image(reader);
    const int64_t stamp_ns = stamp_of(m.header, message);
    if (const auto size = compressed_size(m.format, m.data)) require_camera_size(*size, is_color);
    if (is_color) return add_color(stamp_ns, color_from_compressed(m.data));
    add_depth(stamp_ns, depth_from_compressed(m.format, m.data, depth_unit_m(m)));
  }

  [[nodiscard]] size_t messages_of(const std::string& name) const {
    for (const BagTopic* topic : file_->topics()) {
      if (topic->name == name) return topic->messages;
    }
    return 0;
  }

  /// An image that one camera made between two of the other is not lost.
  [[nodiscard]] bool is_one_faster() const {
    constexpr double kRatio = 1.5;  // of the rates; the usual ones are 15 and 30 Hz
    constexpr size_t kFewest = 10;  // fewer images tell no rate
    const size_t color = messages_of(streams_.color), depth = messages_of(streams_.depth);
    const size_t fewer = std::min(color, depth), more = std::max(color, depth);
    return fewer >= kFewest && static_cast<double>(more) >= kRatio * static_cast<double>(fewer);
  }

  /// Whether the stamp 0 is that of a clock which begins there, as in simulation: the first other stamp is
  /// less than a minute. Otherwise it was left empty.
  [[nodiscard]] bool is_zero_a_time(const std::string& topic) {
    constexpr int64_t kFirst_ns = 60 * kNsPerSecond;
    constexpr size_t kMostMessages = 100;
    file_->select({topic});
    for (size_t i = 0; i < kMostMessages; ++i) {
      try {
        const auto message = file_->next();
        if (!message) break;
        const int64_t stamp_ns = header_stamp_ns(*message);
        if (stamp_ns != 0) return stamp_ns > 0 && stamp_ns < kFirst_ns;
      } catch (const InputError&) {
        continue;  // said when it is read as a frame
      }
    }
    return false;
  }

  [[nodiscard]] static int64_t header_stamp_ns(const BagMessage& message) {
    const RosReader reader(message.data, message.topic->encoding);
    return message.topic->type == "sensor_msgs/CompressedImage"
               ? read_compressed_image(reader).header.stamp_ns
               : read_image(reader).header.stamp_ns;
  }

  /// Some drivers leave the stamp empty.
  [[nodiscard]] int64_t stamp_of(const RosHeader& header, const BagMessage& message) const {
    if (const auto stamps = stamps_of_sdk_.find(message.topic->name); stamps != stamps_of_sdk_.end()) {
      const auto found = stamps->second.find(message.log_ns);
      if (found != stamps->second.end()) return found->second;
    }
    const bool empty = header.stamp_ns == 0 && !times_from_zero_.contains(message.topic->name);
    return empty ? checked_stamp_ns(message.log_ns) : header.stamp_ns;
  }

  [[nodiscard]] double depth_unit_m(const StampedImage& m) {
    return m.image.encoding == "32FC1" ? 1 : chosen_unit_m(bag_unit_m(m));
  }
  [[nodiscard]] double depth_unit_m(const StampedCompressedImage& m) {
    return m.format.starts_with("32FC1") ? 1 : chosen_unit_m(depth_unit_m_);
  }

  /// Newer files of the SDK write the version "1" in place of the frame, and the unit after depth images.
  [[nodiscard]] double bag_unit_m(const StampedImage& m) const {
    if (!of_sdk_ || m.header.frame_id != "1" || m.after.size() < sizeof(float)) return depth_unit_m_;
    const double unit_m = double{ByteReader(m.after).number<float>()};
    return unit_m > 0 ? unit_m_of_sdk(unit_m) : depth_unit_m_;
  }

  void add_color(int64_t stamp_ns, ColorImage image) {
    require_camera_size(image.size(), true);
    pairer_.add_color(stamp_ns, std::move(image));
  }

  void add_depth(int64_t stamp_ns, cv::Mat depth_m) {
    require_camera_size(depth_m.size(), false);
    pairer_.add_depth(stamp_ns, std::move(depth_m));
  }

  void require_camera_size(const cv::Size& size, bool is_color) const {
    const PinholeCamera& camera = is_color ? camera_.color : camera_.depth.value_or(camera_.color);
    if (size.width == camera.width && size.height == camera.height) return;
    throw InputError(fmt::format(
        "{} x {} pixels where the camera has {} x {}; {}", size.width, size.height, camera.width,
        camera.height,
        is_color ? "specify the camera of these images with --camera" : "is depth registered to colour?"));
  }

  [[nodiscard]] Frame with_registered_depth(Frame frame) {
    frame.depth_m = (*preparation_)(frame.depth_m);
    return frame;
  }

  std::unique_ptr<MessageFile> file_;
  SourceInfo info_;
  BagStreams streams_;
  RgbdCamera camera_;
  bool of_sdk_ = false;                   ///< recorded by the RealSense SDK
  std::optional<double> stated_scale_;    ///< units per metre of 16-bit depth, by the user
  double depth_unit_m_ = kRosDepthUnitM;  ///< of 16-bit depth, by the bag
  bool told_unit_ = false;
  SdkStamps stamps_of_sdk_;
  std::set<std::string> times_from_zero_;  ///< topics in which the stamp 0 is a time
  std::optional<DepthPreparation> preparation_;
  FramePairer pairer_;
  bool finished_ = false;
  size_t given_ = 0;
  SkippedFrames skipped_;
};

}  // namespace

bool is_bag(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name.ends_with(".bag.active") || is_compressed_bag(path)) return true;
  const auto extension = path.extension();
  return extension == ".bag" || extension == ".mcap" || extension == ".db3" || is_ros2_bag_folder(path);
}

std::unique_ptr<FrameSource> open_bag(const BagRequest& request) {
  auto file = open_message_file(request.path);
  if (request.topics || !is_own_recording(*file))
    return std::make_unique<BagSource>(std::move(file), request);
  if (request.depth_scale)
    throw UsageError(fmt::format("--depth-scale: {} was recorded by kinloop and states the unit of its depth",
                                 request.path.string()));
  return open_own_recording(std::move(file), request.path, request.camera);
}

std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& path,
                                      const std::optional<RgbdCamera>& camera,
                                      const std::optional<std::string>& topics) {
  BagRequest request;
  request.path = path;
  request.camera = camera;
  request.topics = topics;
  return open_bag(request);
}

}  // namespace kinloop
