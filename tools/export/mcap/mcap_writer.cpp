#include "tools/export/mcap/mcap_writer.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <libdeflate.h>
#include <zstd.h>

#include "drivers/recording_format.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"

namespace kinloop {
namespace {

constexpr size_t kChunkBytes = size_t{1} << 20;

/// The fields of a record, one after the other.
class McapFields {
 public:
  template <class Number>
  McapFields& number(Number value) {
    put_values(bytes_, &value, 1);
    return *this;
  }
  McapFields& text(std::string_view value) { return number(static_cast<uint32_t>(value.size())).raw(value); }
  McapFields& raw(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  [[nodiscard]] std::string record(McapOpcode opcode) const {
    std::string record;
    const uint64_t size = bytes_.size();
    put_values(record, &opcode, 1);
    put_values(record, &size, 1);
    return record + bytes_;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string zstd_compressed(std::string_view bytes) {
  constexpr int kLevel = 1;  // most of the content is compressed already
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  require(ZSTD_isError(size) == 0, "McapWriter: zstd failed");
  packed.resize(size);
  return packed;
}

uint32_t crc_of(std::string_view bytes, uint32_t before = 0) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, const McapOptions& options)
    : path_(path), file_(path), compression_(options.compress ? "zstd" : "") {
  put(kMcapMagic);
  put(McapFields().text(options.profile).text("kinloop").record(McapOpcode::kHeader));
}

void McapWriter::put(std::string_view bytes) {
  file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
  crc_ = crc_of(bytes, crc_);
}

uint16_t McapWriter::add_topic(const McapTopic& topic) {
  const auto id = static_cast<uint16_t>(counts_.size() + 1);
  counts_[id] = 0;
  const std::string schema = McapFields()
                                 .number(id)
                                 .text(topic.schema_name)
                                 .text(topic.schema_encoding)
                                 .text(topic.schema)
                                 .record(McapOpcode::kSchema);
  const std::string channel = McapFields()
                                  .number(id)
                                  .number(id)
                                  .text(topic.name)
                                  .text(topic.message_encoding)
                                  .text("")  // no metadata
                                  .record(McapOpcode::kChannel);
  put(schema + channel);
  schemas_ += schema;
  channels_ += channel;
  return id;
}

void McapWriter::write(uint16_t topic, int64_t stamp_ns, std::string_view message) {
  const auto count = counts_.find(topic);
  require(count != counts_.end(), "McapWriter: no such topic");
  const auto stamp = static_cast<uint64_t>(std::max<int64_t>(stamp_ns, 0));
  const bool first_of_chunk = chunk_.records.empty();
  chunk_.first_ns = first_of_chunk ? stamp : std::min(chunk_.first_ns, stamp);
  chunk_.last_ns = first_of_chunk ? stamp : std::max(chunk_.last_ns, stamp);
  chunk_.index[topic] += McapFields().number(stamp).number(uint64_t{chunk_.records.size()}).bytes();
  chunk_.records += McapFields()
                        .number(topic)
                        .number(static_cast<uint32_t>(count->second))
                        .number(stamp)
                        .number(stamp)
                        .raw(message)
                        .record(McapOpcode::kMessage);
  ++count->second;
  if (chunk_.records.size() >= kChunkBytes) close_chunk();
}

void McapWriter::close_chunk() {
  if (chunk_.records.empty()) return;
  const bool first = chunk_count_++ == 0;
  first_ns_ = first ? chunk_.first_ns : std::min(first_ns_, chunk_.first_ns);
  last_ns_ = first ? chunk_.last_ns : std::max(last_ns_, chunk_.last_ns);
  const uint64_t size = chunk_.records.size(), start = position_;
  const uint32_t crc = crc_of(chunk_.records);
  const std::string packed =
      compression_.empty() ? std::move(chunk_.records) : zstd_compressed(chunk_.records);
  const uint64_t packed_size = packed.size();
  put(McapFields()
          .number(chunk_.first_ns)
          .number(chunk_.last_ns)
          .number(size)
          .number(crc)
          .text(compression_)
          .number(packed_size)
          .raw(packed)
          .record(McapOpcode::kChunk));
  const uint64_t end = position_;
  McapFields offsets;
  for (const auto& [topic, entries] : chunk_.index) {
    offsets.number(topic).number(position_);
    put(McapFields().number(topic).text(entries).record(McapOpcode::kMessageIndex));
  }
  chunk_indexes_ += McapFields()
                        .number(chunk_.first_ns)
                        .number(chunk_.last_ns)
                        .number(start)
                        .number(end - start)
                        .text(offsets.bytes())
                        .number(position_ - end)
                        .text(compression_)
                        .number(packed_size)
                        .number(size)
                        .record(McapOpcode::kChunkIndex);
  chunk_ = {};
}

std::string McapWriter::statistics() const {
  McapFields counts;
  uint64_t messages = 0;
  for (const auto& [topic, count] : counts_) {
    counts.number(topic).number(count);
    messages += count;
  }
  return McapFields()
      .number(messages)
      .number(static_cast<uint16_t>(counts_.size()))
      .number(static_cast<uint32_t>(counts_.size()))
      .number(uint32_t{0})  // attachments
      .number(uint32_t{0})  // metadata
      .number(chunk_count_)
      .number(first_ns_)
      .number(last_ns_)
      .text(counts.bytes())
      .record(McapOpcode::kStatistics);
}

void McapWriter::put_summary() {
  const uint64_t start = position_;
  crc_ = 0;
  std::string offsets;
  const auto put_group = [&](McapOpcode opcode, const std::string& records) {
    if (records.empty()) return;
    offsets += McapFields()
                   .number(opcode)
                   .number(position_)
                   .number(uint64_t{records.size()})
                   .record(McapOpcode::kSummaryOffset);
    put(records);
  };
  put_group(McapOpcode::kSchema, schemas_);
  put_group(McapOpcode::kChannel, channels_);
  put_group(McapOpcode::kStatistics, statistics());
  put_group(McapOpcode::kChunkIndex, chunk_indexes_);
  const uint64_t offsets_start = position_;
  put(offsets);
  std::string footer =
      McapFields().number(start).number(offsets_start).number(uint32_t{0}).record(McapOpcode::kFooter);
  footer.resize(footer.size() - sizeof(uint32_t));  // the checksum covers all before it
  put(footer);
  put(McapFields().number(crc_).bytes());
}

void McapWriter::flush() {
  close_chunk();
  if (!file_.stream().flush())
    throw InputError(fmt::format("{}: writing failed; is the disk full?", path_.string()));
}

void McapWriter::commit(Existing existing) {
  close_chunk();
  put(McapFields().number(crc_).record(McapOpcode::kDataEnd));
  put_summary();
  put(kMcapMagic);
  file_.commit(existing);
}

}  // namespace kinloop
