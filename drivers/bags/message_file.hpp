#pragma once
// A file of time-stamped messages on topics: a bag, whatever its container.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// A topic of a bag.
struct BagTopic {
  std::string name;
  std::string type;      ///< in the form of ROS 1: sensor_msgs/Image
  std::string encoding;  ///< of the messages: ros1 or cdr
  size_t messages = 0;   ///< number of messages, 0 if unknown
};

/// One message; `data` is valid until the next one is read.
struct BagMessage {
  const BagTopic* topic = nullptr;
  int64_t log_ns = 0;  ///< when it was recorded
  Bytes data;
};

class MessageFile {
 public:
  virtual ~MessageFile() = default;

  /// The topics of the whole file; the pointers stay valid.
  [[nodiscard]] virtual std::vector<const BagTopic*> topics() const = 0;

  /// Goes back to the beginning; `next` will return the messages on these topics only.
  virtual void select(const std::set<std::string>& topics) = 0;

  /// Returns the next message in the order of the file; nullopt at the end, which is the last intact message
  /// of a truncated file.
  virtual std::optional<BagMessage> next() = 0;

  /// Returns the damaged parts found since `select`, or by opening the file.
  [[nodiscard]] virtual SkippedFrames damage() const = 0;
};

/// Returns a type in the form of ROS 1: "sensor_msgs/Image" for "sensor_msgs/msg/Image".
std::string ros1_type(std::string type);

/// Returns whether the file is a bag that was compressed as a whole, by its name: .db3.zstd, .mcap.zstd. It
/// must be decompressed first.
bool is_compressed_bag(const std::filesystem::path& path);

/// Opens a .bag (ROS 1), .mcap or .db3 file, or the folder of a ROS 2 bag. Throws InputError naming the file
/// and the remedy if it cannot be read at all.
std::unique_ptr<MessageFile> open_message_file(const std::filesystem::path& path);

}  // namespace kinloop
