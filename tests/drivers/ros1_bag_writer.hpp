#pragma once
// Writes ROS 1 bags, record by record.

#include <cstdint>
#include <map>
#include <string>

namespace kinloop::test {

/// An uncompressed bag of one chunk.
class Ros1BagWriter {
 public:
  void add(const std::string& topic, const std::string& type, int64_t stamp_ns, const std::string& data) {
    const auto [connection, is_new] = connections_.emplace(topic, static_cast<uint32_t>(connections_.size()));
    const std::string id = number(connection->second);
    if (is_new)
      chunk_ += record(field("op", "\x07") + field("conn", id) + field("topic", topic),
                       field("topic", topic) + field("type", type));
    const auto seconds = static_cast<uint32_t>(stamp_ns / kSecond),
               rest = static_cast<uint32_t>(stamp_ns % kSecond);
    chunk_ +=
        record(field("op", "\x02") + field("conn", id) + field("time", number(seconds) + number(rest)), data);
  }

  [[nodiscard]] std::string bytes() const {
    const std::string header = record(
        field("op", "\x03") + field("index_pos", std::string(8, '\0')) + field("conn_count", number(0U)),
        "    ");
    const auto size = static_cast<uint32_t>(chunk_.size());
    return "#ROSBAG V2.0\n" + header +
           record(field("op", "\x05") + field("compression", "none") + field("size", number(size)), chunk_);
  }

 private:
  static constexpr int64_t kSecond = 1'000'000'000;

  static std::string number(uint32_t value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }
  static std::string counted(const std::string& text) {
    return number(static_cast<uint32_t>(text.size())) + text;
  }
  static std::string field(const std::string& name, const std::string& value) {
    return counted(name + "=" + value);
  }
  static std::string record(const std::string& header, const std::string& data) {
    return counted(header) + counted(data);
  }

  std::map<std::string, uint32_t> connections_;
  std::string chunk_;
};

}  // namespace kinloop::test
