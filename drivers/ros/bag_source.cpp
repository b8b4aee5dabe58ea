#include "drivers/ros/bag_source.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"

#ifdef KINLOOP_WITH_ROSBAG

#include <algorithm>
#include <set>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "drivers/live/frame_pairer.hpp"
#include "drivers/ros/ros_image.hpp"
#include "drivers/ros/ros_messages.hpp"
#include "drivers/ros/ros_topics.hpp"
#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

constexpr const char* kCompressedColor = "/compressed";
constexpr const char* kCompressedDepth = "/compressedDepth";

class BagSource : public FrameSource {
 public:
  BagSource(const std::filesystem::path& path, const std::optional<RgbdCamera>& camera,
            const std::optional<std::string>& topics) {
    info_.name = path.string();
    open();
    choose_topics(topics);
    camera_ = camera ? *camera : camera_of_bag();
    view_.addQuery(bag_, rosbag::TopicQuery(std::vector<std::string>{color_topic_, depth_topic_}));
    next_message_ = view_.begin();
    info_.frames = count_of(color_topic_);
  }

  std::optional<RgbdFrame> next() override {
    while (true) {
      if (auto frame = pairer_.next()) {
        ++given_;
        return frame;
      }
      if (finished_) break;
      read_message();
    }
    if (given_ == 0) throw InputError(fmt::format("{}: no usable frame{}", info_.name, first_reason()));
    return std::nullopt;
  }

  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<SkippedFrame> skipped() const override {
    auto all = skipped_;
    all.insert(all.end(), pairer_.unpaired(), {"image", "no image of the other camera within 0.02 s"});
    all.insert(all.end(), pairer_.out_of_order(), {"image", "its timestamp does not increase"});
    return all;
  }

 private:
  void open() {
    try {
      bag_.open(info_.name, rosbag::bagmode::Read);
    } catch (const rosbag::BagUnindexedException&) {
      throw InputError(
          fmt::format("{}: the bag has no index: it is truncated or still being recorded; run rosbag "
                      "reindex on a copy",
                      info_.name));
    } catch (const std::exception& error) {
      throw InputError(fmt::format("{}: cannot read the bag: {}", info_.name, one_line(error.what())));
    }
    for (const auto* connection : rosbag::View(bag_).getConnections()) topics_.insert(connection->topic);
  }

  static std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  /// The topic as named in the bag, raw or compressed; empty if absent.
  [[nodiscard]] std::string in_bag(const std::string& topic, const char* compressed) const {
    if (topics_.contains(topic)) return topic;
    return topics_.contains(topic + compressed) ? topic + compressed : "";
  }

  void choose_topics(const std::optional<std::string>& wanted) {
    std::vector<RosTopics> candidates(known_topics().begin(), known_topics().end());
    if (wanted) candidates = {parse_topics(*wanted)};
    for (const RosTopics& candidate : candidates) {
      color_topic_ = in_bag(candidate.color, kCompressedColor);
      depth_topic_ = in_bag(candidate.depth, kCompressedDepth);
      chosen_ = candidate;
      if (!color_topic_.empty() && !depth_topic_.empty()) return;
    }
    std::string there;
    for (const auto& topic : topics_) there += (there.empty() ? "" : ", ") + topic;
    throw InputError(
        fmt::format("{}: no topics of a known RGB-D camera; use --topics COLOR,DEPTH[,CAMERA_INFO] "
                    "with two of: {}",
                    info_.name, there.empty() ? "(none)" : there));
  }

  [[nodiscard]] size_t count_of(const std::string& topic) const {
    return rosbag::View(bag_, rosbag::TopicQuery(topic)).size();
  }

  [[nodiscard]] RgbdCamera camera_of_bag() const {
    for (const auto& message : rosbag::View(bag_, rosbag::TopicQuery(chosen_.info))) {
      if (const auto m = message.instantiate<ros1::CameraInfo>()) {
        RgbdCamera camera;
        camera.color = camera_from(ros1::from_message(*m), chosen_.rectified());
        return camera;
      }
    }
    throw InputError(
        fmt::format("{}: no camera: no message on topic {}; use --camera FILE", info_.name, chosen_.info));
  }

  /// Passes the next message to the pairer, or detects the end.
  void read_message() {
    if (next_message_ == view_.end()) return finish();
    std::string topic;
    try {
      topic = next_message_->getTopic();
      if (topic == color_topic_) {
        add_color(*next_message_);
      } else {
        add_depth(*next_message_);
      }
      ++next_message_;
    } catch (const InputError& error) {
      skipped_.push_back({topic, error.what()});
      ++next_message_;
    } catch (const std::exception& error) {  // thrown by rosbag: the rest of the file is unreadable
      skipped_.push_back({topic, fmt::format("the bag is damaged from here on: {}", one_line(error.what()))});
      finish();
    }
  }

  void finish() {
    finished_ = true;
    pairer_.finish();
  }

  void add_color(const rosbag::MessageInstance& message) {
    if (const auto m = message.instantiate<ros1::Image>()) {
      pairer_.add_color(ros1::stamp_ns(*m), sized(color_from(ros1::from_message(*m))));
    } else if (const auto c = message.instantiate<ros1::CompressedImage>()) {
      pairer_.add_color(ros1::stamp_ns(*c), sized(color_from_compressed(c->data)));
    } else {
      throw InputError(fmt::format("expected an image message, found type {}", message.getDataType()));
    }
  }

  void add_depth(const rosbag::MessageInstance& message) {
    if (const auto m = message.instantiate<ros1::Image>()) {
      pairer_.add_depth(ros1::stamp_ns(*m), sized(depth_from(ros1::from_message(*m))));
    } else if (const auto c = message.instantiate<ros1::CompressedImage>()) {
      pairer_.add_depth(ros1::stamp_ns(*c), sized(depth_from_compressed(c->format.c_str(), c->data)));
    } else {
      throw InputError(fmt::format("expected an image message, found type {}", message.getDataType()));
    }
  }

  /// Returns the image after checking that it has the camera's size.
  template <class Image>
  [[nodiscard]] Image sized(Image image) const {
    const cv::Size size = image.size();
    if (size.width == camera_.color.width && size.height == camera_.color.height) return image;
    throw InputError(
        fmt::format("{} x {} pixels where the camera has {} x {}; is depth registered to colour?", size.width,
                    size.height, camera_.color.width, camera_.color.height));
  }

  [[nodiscard]] std::string first_reason() const {
    const auto all = skipped();
    return all.empty() ? "" : "; the first: " + all.front().reason;
  }

  SourceInfo info_;
  rosbag::Bag bag_;
  rosbag::View view_;
  rosbag::View::iterator next_message_;
  std::set<std::string> topics_;
  RosTopics chosen_;
  std::string color_topic_, depth_topic_;  ///< as in the bag
  RgbdCamera camera_;
  FramePairer pairer_;
  bool finished_ = false;
  size_t given_ = 0;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace

bool bags_available() {
  return true;
}

std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& path,
                                      const std::optional<RgbdCamera>& camera,
                                      const std::optional<std::string>& topics) {
  return std::make_unique<BagSource>(path, camera, topics);
}

}  // namespace kinloop

#else

namespace kinloop {

bool bags_available() {
  return false;
}

std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& path, const std::optional<RgbdCamera>&,
                                      const std::optional<std::string>&) {
  throw UsageError(fmt::format(
      "{}: ROS bags are not supported by this build; install librosbag-storage-dev and libsensor-msgs-dev "
      "and rebuild",
      path.string()));
}

}  // namespace kinloop

#endif
