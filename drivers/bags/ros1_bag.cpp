#include <map>

#include "drivers/bags/bag_files.hpp"
#include "drivers/bags/chunk_decompression.hpp"
#include "drivers/bags/record_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr auto kBagMagic = "#ROSBAG V2.0\n"sv;

/// Record types, the field "op".
enum BagOp : uint8_t {
  kBagMessage = 0x02,
  kBagHeader = 0x03,
  kBagChunk = 0x05,
  kBagChunkInfo = 0x06,
  kBagConnection = 0x07
};

/// The header of a record: fields "name=value", each after its length.
class BagFields {
 public:
  explicit BagFields(Bytes header) {
    ByteReader reader(header);
    while (reader.left() > 0) {
      const auto field = as_text(reader.block(reader.number<uint32_t>()));
      const size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw InputError("a field without '='");
      fields_[std::string(field.substr(0, equals))] = field.substr(equals + 1);
    }
  }

  template <class Number>
  [[nodiscard]] Number number(const char* name) const {
    return ByteReader(as_bytes(text(name))).number<Number>();
  }
  [[nodiscard]] std::string_view text(const char* name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) throw InputError(fmt::format("a record without the field '{}'", name));
    return found->second;
  }

 private:
  std::map<std::string, std::string_view> fields_;
};

struct BagRecord {
  Bytes header, data;
};

BagRecord next_bag_record(ByteReader& reader) {
  const Bytes header = reader.block(reader.number<uint32_t>());
  return {header, reader.block(reader.number<uint32_t>())};
}

class Ros1Bag final : public RecordFile {
 public:
  explicit Ros1Bag(const std::filesystem::path& path)
      : RecordFile(path, kBagMagic, "not a ROS 1 bag: it does not begin with #ROSBAG V2.0") {
    if (!read_index()) read_all_topics();
  }

  [[nodiscard]] std::vector<const BagTopic*> topics() const override {
    std::vector<const BagTopic*> all;
    for (const auto& [name, topic] : topics_) all.push_back(&topic);
    return all;
  }

 private:
  std::optional<BagMessage> read_chunk_record(ByteReader& records) override {
    return handle(next_bag_record(records));
  }

  bool read_file_record(std::optional<BagMessage>& message) override {
    const auto record = next_in_file();
    if (record) message = handle(*record);
    return record.has_value();
  }

  /// A block after its 32-bit length.
  std::optional<Bytes> read_counted_block(std::vector<uint8_t>& buffer) {
    const auto length = read_block(sizeof(uint32_t), buffer);
    return length ? read_block(ByteReader(*length).number<uint32_t>(), buffer) : std::nullopt;
  }

  /// The next record outside of chunks.
  std::optional<BagRecord> next_in_file() {
    begin_record();
    if (left() == 0) return std::nullopt;
    const auto header = read_counted_block(header_);
    const auto data = header ? read_counted_block(data_) : std::nullopt;
    if (data) return BagRecord{*header, *data};
    stop("the file is truncated or damaged from here on");
    return std::nullopt;
  }

  /// Returns the message if the record is one on a selected topic; opens chunks and remembers connections.
  std::optional<BagMessage> handle(const BagRecord& record) {
    const BagFields fields(record.header);
    const auto op = fields.number<uint8_t>("op");
    if (op == kBagChunk) read_chunk(fields, record.data);
    if (op == kBagConnection) add_connection(fields, record.data);
    if (op == kBagMessage) return message(fields, record.data);
    return std::nullopt;
  }

  void read_chunk(const BagFields& fields, Bytes data) {
    const auto compression = fields.text("compression");
    if (compression != "none") chunk_ = decompressed(compression, data, fields.number<uint32_t>("size"));
    open_chunk(compression == "none" ? data : Bytes(chunk_));
  }

  void add_connection(const BagFields& fields, Bytes data) {
    const auto name = printable(fields.text("topic"));
    const BagFields details(data);
    const auto id = fields.number<uint32_t>("conn");
    topics_.emplace(name, BagTopic{name, printable(details.text("type")), "ros1", 0});
    connections_[id] = name;  // not before: a damaged record must not leave one without topic
  }

  std::optional<BagMessage> message(const BagFields& fields, Bytes data) {
    const auto connection = connections_.find(fields.number<uint32_t>("conn"));
    if (connection == connections_.end()) throw InputError("a message of an undefined connection");
    BagTopic& topic = topics_.at(connection->second);
    if (!wants_message_of(topic)) return std::nullopt;
    ByteReader time(as_bytes(fields.text("time")));
    const auto seconds = int64_t{time.number<uint32_t>()};
    return BagMessage{&topic, seconds * kNsPerSecond + time.number<uint32_t>(), data};
  }

  /// Reads the connections and counts after the chunks; returns false if there are none.
  bool read_index() {
    try {
      select({});
      const auto header = next_in_file();
      if (!header) return false;
      const auto index = BagFields(header->header).number<uint64_t>("index_pos");
      if (index == 0 || index > size()) return false;
      move_to(index);
      while (const auto record = next_in_file()) {
        handle(*record);
        const BagFields fields(record->header);
        if (fields.number<uint8_t>("op") == kBagChunkInfo) add_counts(record->data);
      }
      if (damage().empty() && !topics_.empty()) return true;
    } catch (const InputError&) {
    }
    topics_.clear(), connections_.clear();
    return false;
  }

  void add_counts(Bytes data) {
    ByteReader counts(data);
    while (counts.left() > 0) {
      const auto connection = connections_.find(counts.number<uint32_t>());
      const auto messages = counts.number<uint32_t>();
      if (connection != connections_.end()) topics_.at(connection->second).messages += messages;
    }
  }

  std::map<uint32_t, std::string> connections_;  ///< their topics; a topic may have several
  std::map<std::string, BagTopic> topics_;
  std::vector<uint8_t> header_, data_;  ///< of the current record of the file
  std::vector<uint8_t> chunk_;          ///< decompressed
};

}  // namespace

std::unique_ptr<MessageFile> open_ros1_bag(const std::filesystem::path& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace kinloop
