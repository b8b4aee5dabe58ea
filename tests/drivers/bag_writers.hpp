#pragma once
// Small writers of .mcap and .db3 files.

#include <filesystem>
#include <fstream>
#include <map>

#include <fmt/format.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include "drivers/bags/chunk_decompression.hpp"
#include "tests/drivers/message_writer.hpp"

namespace kinloop::test {

struct WrittenMessage {
  std::string topic;
  std::string type;  ///< as in ROS 2: sensor_msgs/msg/Image
  int64_t log_ns = 0;
  std::string data;
};
using WrittenBag = std::vector<WrittenMessage>;

struct McapLayout {
  std::string compression;  ///< "", "lz4" or "zstd"
  bool chunks = true;
  bool summary = true;
  size_t messages_per_chunk = 3;
  std::string encoding = "cdr";
};

inline std::string compressed(const std::string& compression, const std::string& data) {
  if (compression.empty()) return data;
  const bool lz4 = compression == "lz4";
  std::string result(lz4 ? LZ4F_compressFrameBound(data.size(), nullptr) : ZSTD_compressBound(data.size()),
                     '\0');
  result.resize(lz4 ? LZ4F_compressFrame(result.data(), result.size(), data.data(), data.size(), nullptr)
                    : ZSTD_compress(result.data(), result.size(), data.data(), data.size(), 1));
  return result;
}

/// Little-endian fields of MCAP.
class McapRecord {
 public:
  template <class Number>
  McapRecord& number(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  McapRecord& text(std::string_view value) {
    number(static_cast<uint32_t>(value.size()));
    return raw(value);
  }
  McapRecord& raw(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  [[nodiscard]] std::string with_opcode(uint8_t opcode) const {
    return McapRecord().number(opcode).number(uint64_t{bytes_.size()}).raw(bytes_).bytes_;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// An MCAP file that grows by messages.
class McapWriter {
 public:
  explicit McapWriter(McapLayout layout) : layout_(std::move(layout)) {
    file_ = magic() + McapRecord().text("ros2").text("test").with_opcode(1);
  }

  void add(const WrittenMessage& message) {
    std::string& out = layout_.chunks ? chunk_ : file_;
    const auto [channel, is_new] =
        channels_.emplace(message.topic, static_cast<uint16_t>(channels_.size() + 1));
    const uint16_t id = channel->second;
    if (is_new) {
      const std::string definition =
          McapRecord().number(id).text(message.type).text("ros2msg").text("").with_opcode(3) +
          McapRecord()
              .number(id)
              .number(id)
              .text(message.topic)
              .text(layout_.encoding)
              .number(uint32_t{0})
              .with_opcode(4);
      out += definition, definitions_ += definition;
    }
    ++counts_[id], ++messages_;
    out += McapRecord()
               .number(id)
               .number(uint32_t{0})
               .number(message.log_ns)
               .number(message.log_ns)
               .raw(message.data)
               .with_opcode(5);
    if (layout_.chunks && messages_ % layout_.messages_per_chunk == 0) close_chunk();
  }

  std::string finish() {
    close_chunk();
    if (layout_.summary) add_summary();
    return file_;
  }

 private:
  static std::string magic() { return {"\x89MCAP0\r\n", 8}; }

  void close_chunk() {
    if (chunk_.empty()) return;
    const std::string packed = compressed(layout_.compression, chunk_);
    file_ += McapRecord()
                 .number(uint64_t{0})
                 .number(uint64_t{0})
                 .number(uint64_t{chunk_.size()})
                 .number(crc32(as_bytes(chunk_)))
                 .text(layout_.compression)
                 .number(uint64_t{packed.size()})
                 .raw(packed)
                 .with_opcode(6);
    file_ += McapRecord().number(uint16_t{1}).number(uint32_t{0}).with_opcode(7);  // a message index
    chunk_.clear();
  }

  void add_summary() {
    file_ += McapRecord().number(uint32_t{0}).with_opcode(0x0F);
    McapRecord counts;
    for (const auto& [id, count] : counts_) counts.number(id).number(count);
    const uint64_t start = file_.size();
    file_ += definitions_;
    file_ += McapRecord()
                 .number(uint64_t{messages_})
                 .number(uint16_t{1})
                 .number(uint32_t{1})
                 .number(uint32_t{0})
                 .number(uint32_t{0})
                 .number(uint32_t{1})
                 .number(uint64_t{0})
                 .number(uint64_t{0})
                 .text(counts.bytes())
                 .with_opcode(0x0B);
    std::string footer = McapRecord().number(start).number(uint64_t{0}).number(uint32_t{0}).with_opcode(2);
    footer.resize(footer.size() - sizeof(uint32_t));
    const uint32_t crc = crc32(as_bytes(file_.substr(start) + footer));
    file_ += footer + McapRecord().number(crc).bytes() + magic();
  }

  McapLayout layout_;
  std::string file_, definitions_, chunk_;
  std::map<std::string, uint16_t> channels_;
  std::map<uint16_t, uint64_t> counts_;
  size_t messages_ = 0;
};

/// The bytes of an MCAP file.
inline std::string mcap_bytes(const WrittenBag& bag, const McapLayout& layout) {
  McapWriter writer(layout);
  for (const WrittenMessage& message : bag) writer.add(message);
  return writer.finish();
}

/// Writes a .db3 file as rosbag2 does; throws on failure.
inline void write_db3(const std::filesystem::path& path, const WrittenBag& bag, bool zstd_messages = false) {
  std::filesystem::remove(path);
  sqlite3* database = nullptr;
  const auto check = [&](int result) {
    if (result != SQLITE_OK && result != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(database));
  };
  check(sqlite3_open(path.c_str(), &database));
  check(sqlite3_exec(
      database,
      "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL,"
      "data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN",
      nullptr, nullptr, nullptr));
  std::map<std::string, int> topics;
  sqlite3_stmt* insert = nullptr;
  check(sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", -1,
                           &insert, nullptr));
  for (const WrittenMessage& message : bag) {
    const auto [topic, is_new] = topics.emplace(message.topic, static_cast<int>(topics.size() + 1));
    if (is_new) {
      check(sqlite3_exec(database,
                         fmt::format("INSERT INTO topics VALUES({},'{}','{}','cdr','')", topic->second,
                                     message.topic, message.type)
                             .c_str(),
                         nullptr, nullptr, nullptr));
    }
    const std::string data = zstd_messages ? compressed("zstd", message.data) : message.data;
    check(sqlite3_reset(insert));
    check(sqlite3_bind_int(insert, 1, topic->second));
    check(sqlite3_bind_int64(insert, 2, message.log_ns));
    check(sqlite3_bind_blob64(insert, 3, data.data(), data.size(), SQLITE_TRANSIENT));
    check(sqlite3_step(insert));
  }
  sqlite3_finalize(insert);
  check(sqlite3_exec(database, "COMMIT", nullptr, nullptr, nullptr));
  sqlite3_close(database);
}

}  // namespace kinloop::test
