#include "drivers/bags/ros1_bag.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"

#ifdef KINLOOP_WITH_ROSBAG

#include <map>

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

namespace kinloop {
namespace {

class Ros1Bag : public MessageFile {
 public:
  explicit Ros1Bag(const std::filesystem::path& path) : name_(path.string()) {
    try {
      bag_.open(name_, rosbag::bagmode::Read);
      read_topics();
    } catch (const rosbag::BagUnindexedException&) {
      throw InputError(
          fmt::format("{}: the bag has no index: it is truncated or still being recorded; run rosbag "
                      "reindex on a copy",
                      name_));
    } catch (const std::exception& error) {
      throw InputError(fmt::format("{}: cannot read the bag: {}", name_, printable(error.what())));
    }
  }

  [[nodiscard]] std::vector<const BagTopic*> topics() const override {
    std::vector<const BagTopic*> all;
    for (const auto& [name, topic] : topics_) all.push_back(&topic);
    return all;
  }

  void select(const std::set<std::string>& topics) override {
    damage_.clear();
    view_ = std::make_unique<rosbag::View>();
    view_->addQuery(bag_, rosbag::TopicQuery(std::vector<std::string>(topics.begin(), topics.end())));
    next_ = view_->begin();
  }

  std::optional<BagMessage> next() override {
    if (view_ == nullptr || next_ == view_->end()) return std::nullopt;
    try {
      const rosbag::MessageInstance& message = *next_;
      bytes_.resize(message.size());
      ros::serialization::OStream stream(bytes_.data(), static_cast<uint32_t>(bytes_.size()));
      message.write(stream);
      const BagMessage result{&topics_.at(message.getTopic()),
                              static_cast<int64_t>(message.getTime().toNSec()), bytes_};
      ++next_;
      return result;
    } catch (const std::exception& error) {  // the rest of the file is unreadable
      damage_.push_back({name_, fmt::format("the bag is damaged from here on: {}", printable(error.what()))});
      view_.reset();
      return std::nullopt;
    }
  }

  [[nodiscard]] std::vector<SkippedFrame> damage() const override { return damage_; }

 private:
  void read_topics() {
    for (const auto* connection : rosbag::View(bag_).getConnections()) {
      BagTopic& topic = topics_[connection->topic];
      topic = {printable(connection->topic), printable(connection->datatype), "ros1", 0};
      topic.messages = rosbag::View(bag_, rosbag::TopicQuery(connection->topic)).size();
    }
  }

  std::string name_;
  rosbag::Bag bag_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator next_;
  std::map<std::string, BagTopic> topics_;
  std::vector<uint8_t> bytes_;
  std::vector<SkippedFrame> damage_;
};

}  // namespace

std::unique_ptr<MessageFile> open_ros1_bag(const std::filesystem::path& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace kinloop

#else

namespace kinloop {

std::unique_ptr<MessageFile> open_ros1_bag(const std::filesystem::path& path) {
  throw UsageError(fmt::format(
      "{}: ROS 1 bags are not supported by this build; install librosbag-storage-dev and libsensor-msgs-dev "
      "and rebuild",
      path.string()));
}

}  // namespace kinloop

#endif
