#include "drivers/bags/record_file.hpp"

#include <fmt/format.h>

#include "drivers/bags/chunk_decompression.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {

RecordFile::RecordFile(const std::filesystem::path& path, std::string_view magic, std::string_view otherwise)
    : name_(path.string()), magic_bytes_(magic.size()) {
  require_regular_file(path);
  file_.open(path, std::ios::binary);
  if (!file_) throw InputError(fmt::format("{}: cannot be opened; check the path and the rights", name_));
  size_ = std::filesystem::file_size(path);
  std::string begin(magic.size(), '\0');
  file_.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (!file_ || begin != magic) throw InputError(fmt::format("{}: {}", name_, otherwise));
}

void RecordFile::select(const std::set<std::string>& topics) {
  selected_ = topics;
  records_ = ByteReader({});
  damage_.clear();
  position_ = magic_bytes_;
}

std::optional<BagMessage> RecordFile::next() {
  while (true) {
    while (records_.left() > 0) {
      if (auto message = next_in_chunk()) return message;
    }
    std::optional<BagMessage> message;
    try {
      if (!read_file_record(message)) return std::nullopt;
    } catch (const InputError& error) {
      report(fmt::format("a record is skipped: {}", error.what()));
    }
    if (message) return message;
  }
}

std::optional<BagMessage> RecordFile::next_in_chunk() {
  try {
    return read_chunk_record(records_);
  } catch (const InputError& error) {
    report(fmt::format("the rest of a chunk is skipped: {}", error.what()));
    records_ = ByteReader({});
    return std::nullopt;
  }
}

void RecordFile::read_all_topics() {
  counting_ = true;
  select({});
  while (next()) {
  }
  counting_ = false;
}

bool RecordFile::wants_message_of(BagTopic& topic) {
  if (counting_) ++topic.messages;
  return selected_.contains(topic.name);
}

std::optional<Bytes> RecordFile::read_block(uint64_t length, std::vector<uint8_t>& buffer) {
  if (length > left() || length > kMaxBlockBytes) return std::nullopt;
  buffer.resize(static_cast<size_t>(length));
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position_));
  file_.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(length));
  if (!file_) return std::nullopt;
  position_ += length;
  return Bytes(buffer);
}

void RecordFile::report(const std::string& what) {
  damage_.add({name_, fmt::format("at byte {}: {}", record_start_, what)});
}

void RecordFile::stop(const std::string& why) {
  report(why);
  position_ = size_;
}

}  // namespace kinloop
