#include <map>

#include "drivers/bags/bag_files.hpp"
#include "drivers/bags/chunk_decompression.hpp"
#include "drivers/bags/record_file.hpp"
#include "drivers/recording_format.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr size_t kRecordHeaderBytes = 9;                         // type and length
constexpr size_t kFooterBytes = kRecordHeaderBytes + 8 + 8 + 4;  // summary, summary offsets, checksum

/// Of a chunk: compressed, a file of a few bytes holds millions.
constexpr size_t kMaxBadRecords = 10'000;

struct Record {
  McapOpcode opcode = {};
  Bytes content;
};

Record next_record(ByteReader& reader) {
  const auto opcode = static_cast<McapOpcode>(reader.number<uint8_t>());
  return {opcode, reader.block(reader.number<uint64_t>())};
}

class McapFile final : public RecordFile {
 public:
  explicit McapFile(const std::filesystem::path& path)
      : RecordFile(path, kMcapMagic, "not an MCAP file: it does not begin with its signature") {
    if (!read_summary()) read_all_topics();
  }

  [[nodiscard]] std::vector<const BagTopic*> topics() const override {
    std::vector<const BagTopic*> all;
    for (const auto& [id, topic] : channels_) all.push_back(&topic);
    return all;
  }

 private:
  std::optional<BagMessage> read_chunk_record(ByteReader& records) override {
    if (reported() > reported_before_chunk_ + kMaxBadRecords) throw InputError("too many bad records");
    return handle(next_record(records));
  }

  bool read_file_record(std::optional<BagMessage>& message) override {
    const auto record = next_in_file();
    if (!record) return false;
    if (record->opcode == McapOpcode::kChunk) {
      read_chunk(record->content);
    } else {
      message = handle(*record);
    }
    return true;
  }

  /// The next record outside of chunks, up to the end of the data section.
  std::optional<Record> next_in_file() {
    while (true) {
      begin_record();
      if (left() == 0) return end("the file ends without its summary: it is truncated");
      const auto header = read_block(kRecordHeaderBytes, buffer_);
      if (!header) return end("the file is truncated");
      ByteReader reader(*header);
      const auto opcode = static_cast<McapOpcode>(reader.number<uint8_t>());
      const auto length = reader.number<uint64_t>();
      if (opcode == McapOpcode::kDataEnd || opcode == McapOpcode::kFooter) return std::nullopt;
      const bool used = opcode == McapOpcode::kSchema || opcode == McapOpcode::kChannel ||
                        opcode == McapOpcode::kMessage || opcode == McapOpcode::kChunk;
      if (length > left()) return end("the file is truncated");
      if (!used) {
        move_to(position() + length);
        continue;
      }
      if (const auto content = read_block(length, buffer_)) return Record{opcode, *content};
      return end(fmt::format("a record of {} bytes; the file is damaged from here on", length));
    }
  }

  std::optional<Record> end(const std::string& why) {
    stop(why);
    return std::nullopt;
  }

  void read_chunk(Bytes content) {
    try {
      ByteReader reader(content);
      reader.block(8 + 8);  // first and last time
      const auto size = reader.number<uint64_t>();
      const auto crc = reader.number<uint32_t>();
      const std::string compression = reader.string();
      const Bytes data = reader.block(reader.number<uint64_t>());
      if (!compression.empty()) chunk_ = decompressed(compression, data, size);
      const Bytes records = compression.empty() ? data : Bytes(chunk_);
      if (crc != 0 && crc32(records) != crc) throw InputError("the checksum is wrong");
      reported_before_chunk_ = reported();
      open_chunk(records);
    } catch (const InputError& error) {
      report(fmt::format("a chunk is skipped: {}", error.what()));
    }
  }

  /// Returns the message if the record is one on a selected topic; remembers schemas and channels.
  std::optional<BagMessage> handle(const Record& record) {
    try {
      ByteReader reader(record.content);
      if (record.opcode == McapOpcode::kSchema) add_schema(reader);
      if (record.opcode == McapOpcode::kChannel) add_channel(reader);
      if (record.opcode == McapOpcode::kMessage) return message(reader);
    } catch (const InputError& error) {
      report(fmt::format("a record is skipped: {}", error.what()));
    }
    return std::nullopt;
  }

  void add_schema(ByteReader& reader) {
    const auto id = reader.number<uint16_t>();
    schemas_[id] = reader.string();
  }

  void add_channel(ByteReader& reader) {
    const auto id = reader.number<uint16_t>();
    const auto schema = reader.number<uint16_t>();
    BagTopic topic;
    topic.name = reader.string();
    topic.encoding = reader.string();
    topic.type = ros1_type(schemas_[schema]);
    channels_.emplace(id, std::move(topic));  // repeated definitions are the same
  }

  std::optional<BagMessage> message(ByteReader& reader) {
    const auto channel = channels_.find(reader.number<uint16_t>());
    if (channel == channels_.end()) throw InputError("a message of an undefined channel");
    if (!wants_message_of(channel->second)) return std::nullopt;
    reader.number<uint32_t>();  // sequence number
    const auto log_ns = static_cast<int64_t>(reader.number<uint64_t>());
    reader.number<uint64_t>();  // when it was published
    return BagMessage{&channel->second, log_ns, reader.block(reader.left())};
  }

  /// Reads topics and counts from the summary; returns false if it is missing or damaged.
  bool read_summary() {
    if (size() < kMcapMagic.size() * 2 + kFooterBytes) return false;
    const uint64_t footer_start = size() - kMcapMagic.size() - kFooterBytes;
    move_to(footer_start);
    const auto footer = read_block(kFooterBytes + kMcapMagic.size(), buffer_);
    if (!footer || as_text(*footer).substr(kFooterBytes) != kMcapMagic ||
        static_cast<McapOpcode>((*footer)[0]) != McapOpcode::kFooter)
      return false;
    ByteReader reader(footer->subspan(kRecordHeaderBytes));
    const auto start = reader.number<uint64_t>();
    reader.number<uint64_t>();  // start of the summary offsets
    const auto crc = reader.number<uint32_t>();
    if (start == 0 || start >= footer_start) return false;
    move_to(start);
    const auto summary = read_block(size() - kMcapMagic.size() - start, buffer_);
    if (!summary) return false;
    if (crc != 0 && crc32(summary->first(summary->size() - 4)) != crc) return false;
    return read_summary_records(summary->first(static_cast<size_t>(footer_start - start)));
  }

  bool read_summary_records(Bytes records) {
    bool counted = false;
    try {
      ByteReader reader(records);
      while (reader.left() > 0) {
        const Record record = next_record(reader);
        ByteReader content(record.content);
        if (record.opcode == McapOpcode::kSchema) add_schema(content);
        if (record.opcode == McapOpcode::kChannel) add_channel(content);
        if (record.opcode == McapOpcode::kStatistics) counted = add_counts(content);
      }
    } catch (const InputError&) {
      counted = false;
    }
    if (!counted || channels_.empty()) channels_.clear(), schemas_.clear();
    return !channels_.empty();
  }

  /// Statistics; the counts are their last field.
  bool add_counts(ByteReader& reader) {
    reader.block(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8);
    ByteReader counts(reader.block(reader.number<uint32_t>()));
    while (counts.left() > 0) {
      const auto channel = channels_.find(counts.number<uint16_t>());
      const auto messages = counts.number<uint64_t>();
      if (channel != channels_.end()) channel->second.messages = static_cast<size_t>(messages);
    }
    return true;
  }

  std::map<uint16_t, std::string> schemas_;  ///< names of types
  std::map<uint16_t, BagTopic> channels_;
  std::vector<uint8_t> buffer_;  ///< the current record of the file
  std::vector<uint8_t> chunk_;   ///< decompressed
  size_t reported_before_chunk_ = 0;
};

}  // namespace

std::unique_ptr<MessageFile> open_mcap(const std::filesystem::path& path) {
  return std::make_unique<McapFile>(path);
}

}  // namespace kinloop
