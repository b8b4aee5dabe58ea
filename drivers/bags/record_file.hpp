#pragma once
// A bag that is one file of records, some of them in chunks. This part reads the file; what a record holds is
// the business of each format.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/bags/message_file.hpp"

namespace kinloop {

class RecordFile : public MessageFile {
 public:
  void select(const std::set<std::string>& topics) final;
  std::optional<BagMessage> next() final;
  [[nodiscard]] SkippedFrames damage() const final { return damage_; }

 protected:
  /// Throws InputError if the file cannot be opened, and with the text `otherwise` if it does not begin with
  /// `magic`.
  RecordFile(const std::filesystem::path& path, std::string_view magic, std::string_view otherwise);

  /// Reads the next record of a chunk. Returns its message if that is wanted. Throws InputError if the rest
  /// of the chunk cannot be read.
  virtual std::optional<BagMessage> read_chunk_record(ByteReader& records) = 0;

  /// Reads the next record of the file: a message goes to `message` if it is wanted, a chunk to `open_chunk`.
  /// Returns false at the end. Throws InputError if the record has to be skipped.
  virtual bool read_file_record(std::optional<BagMessage>& message) = 0;

  /// Goes through the whole file, which counts the messages of each topic.
  void read_all_topics();

  /// Counts a message of a topic. Returns whether the topic is selected.
  bool wants_message_of(BagTopic& topic);

  /// The next messages come from these records, which must stay valid.
  void open_chunk(Bytes records) { records_ = ByteReader(records); }

  [[nodiscard]] uint64_t size() const { return size_; }
  [[nodiscard]] uint64_t position() const { return position_; }
  [[nodiscard]] uint64_t left() const { return size_ - position_; }
  void move_to(uint64_t position) { position_ = position; }

  /// Reports name the place where the current record begins.
  void begin_record() { record_start_ = position_; }

  /// Reads `length` bytes at the current position; nullopt if the file is shorter.
  std::optional<Bytes> read_block(uint64_t length, std::vector<uint8_t>& buffer);

  void report(const std::string& what);
  [[nodiscard]] size_t reported() const { return damage_.size(); }
  /// Reports damage and goes to the end of the file.
  void stop(const std::string& why);

 private:
  std::optional<BagMessage> next_in_chunk();

  std::string name_;
  size_t magic_bytes_;
  std::ifstream file_;
  uint64_t size_ = 0, position_ = 0, record_start_ = 0;
  std::set<std::string> selected_;
  bool counting_ = false;
  ByteReader records_{Bytes()};  ///< what is left of the chunk
  SkippedFrames damage_;
};

}  // namespace kinloop
