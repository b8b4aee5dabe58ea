#pragma once
// In: messages. Out: an MCAP file (mcap.dev/spec) with compressed chunks, their indexes and a summary, so
// that viewers find every message without reading the whole file.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kinloop/core/files/text_file.hpp"

namespace kinloop {

/// A topic, of messages in JSON unless it says otherwise.
struct McapTopic {
  std::string name;
  std::string schema_name;
  std::string schema;
  std::string schema_encoding = "jsonschema";
  std::string message_encoding = "json";
};

struct McapOptions {
  std::string profile;   ///< of the messages, as registered; empty: none
  bool compress = true;  ///< chunks, with zstd
};

/// The file appears under its name only when complete.
class McapWriter {
 public:
  /// Throws InputError if the file cannot be created.
  explicit McapWriter(const std::filesystem::path& path, const McapOptions& options = {});

  /// Returns the number of the topic for `write`.
  uint16_t add_topic(const McapTopic& topic);

  /// Adds a message. Messages in order of their stamps make the best index.
  void write(uint16_t topic, int64_t stamp_ns, std::string_view message);

  /// Ends the chunk and hands it to the disk: what is lost later is what was added later. Throws InputError
  /// if it cannot be written.
  void flush();

  /// Writes the summary and renames the file. Throws InputError on failure.
  void commit(Existing existing = Existing::kReplaced);

  /// Gives the file its name without a summary: readers find its messages by reading the whole of it.
  void keep_recording() noexcept { file_.keep_recording(); }

 private:
  struct Chunk {
    std::string records;
    uint64_t first_ns = 0, last_ns = 0;
    std::map<uint16_t, std::string> index;  ///< by topic: stamps and offsets
  };

  void put(std::string_view bytes);
  void close_chunk();
  void put_summary();
  [[nodiscard]] std::string statistics() const;

  std::filesystem::path path_;
  AtomicFile file_;
  std::string compression_;
  uint64_t position_ = 0;
  uint32_t crc_ = 0;  ///< of all bytes so far
  Chunk chunk_;
  std::string schemas_, channels_, chunk_indexes_;  ///< for the summary
  std::map<uint16_t, uint64_t> counts_;             ///< messages by topic
  uint32_t chunk_count_ = 0;
  uint64_t first_ns_ = 0, last_ns_ = 0;
};

}  // namespace kinloop
