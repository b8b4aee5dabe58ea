#include <limits>
#include <map>

#include <fmt/ranges.h>
#include <sqlite3.h>

#include "drivers/bags/bag_files.hpp"
#include "drivers/bags/chunk_decompression.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/untrusted_database.hpp"

namespace kinloop {
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, CloseStatement>;

class SqliteBag : public MessageFile {
 public:
  explicit SqliteBag(const std::filesystem::path& path) : name_(path.string()) {
    open();
    read_topics();
  }

  [[nodiscard]] std::vector<const BagTopic*> topics() const override {
    std::vector<const BagTopic*> all;
    for (const auto& [id, topic] : topics_) all.push_back(&topic);
    return all;
  }

  void select(const std::set<std::string>& topics) override {
    damage_.clear();
    std::vector<int64_t> ids;
    for (const auto& [id, topic] : topics_) {
      if (topics.contains(topic.name)) ids.push_back(id);
    }
    last_row_ = std::numeric_limits<int64_t>::min();
    messages_ = prepared(fmt::format(
        "SELECT topic_id, timestamp, data, rowid FROM messages WHERE topic_id IN ({}) ORDER BY rowid",
        fmt::join(ids, ",")));
  }

  std::optional<BagMessage> next() override {
    while (messages_) {
      const int result = sqlite3_step(messages_.get());
      if (result == SQLITE_DONE) {
        messages_.reset();
      } else if (result != SQLITE_ROW) {
        end(printable(sqlite3_errmsg(database_.get())));
      } else if (sqlite3_column_int64(messages_.get(), 3) <= last_row_) {
        end("its pages form a cycle");
      } else if (auto message = current()) {
        return message;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] SkippedFrames damage() const override { return damage_; }

 private:
  void report(const std::string& what) { damage_.add({name_, what}); }

  void end(const std::string& why) {
    report("damaged from here on: " + why);
    messages_.reset();
  }

  [[noreturn]] void reject(const std::string& why) const {
    throw InputError(fmt::format(
        "{}: not a readable ROS 2 bag: {}; if it is damaged, try `sqlite3 {} .recover`", name_, why, name_));
  }

  void open() {
    require_regular_file(name_);
    sqlite3* raw = nullptr;
    const int result =
        sqlite3_open_v2(name_.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(raw);
    if (result != SQLITE_OK)
      throw InputError(fmt::format("{}: cannot be opened; check the path and the rights", name_));
    set_untrusted(raw, std::filesystem::file_size(name_), kMaxBlockBytes);
  }

  [[nodiscard]] Statement prepared(const std::string& sql) const {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &raw, nullptr) != SQLITE_OK)
      reject(printable(sqlite3_errmsg(database_.get())));
    return Statement(raw);
  }

  void read_topics() {
    const Statement rows = prepared("SELECT id, name, type, serialization_format FROM topics");
    int result = SQLITE_OK;
    while ((result = sqlite3_step(rows.get())) == SQLITE_ROW) {
      BagTopic& topic = topics_[sqlite3_column_int64(rows.get(), 0)];
      topic.name = text(rows, 1);
      topic.type = ros1_type(text(rows, 2));
      topic.encoding = text(rows, 3);
    }
    if (result != SQLITE_DONE) reject(printable(sqlite3_errmsg(database_.get())));
    count_messages();
  }

  /// A damaged file has no counts; they only serve the progress bar.
  void count_messages() {
    const Statement rows = prepared("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id");
    while (sqlite3_step(rows.get()) == SQLITE_ROW) {
      const auto topic = topics_.find(sqlite3_column_int64(rows.get(), 0));
      if (topic != topics_.end())
        topic->second.messages = static_cast<size_t>(sqlite3_column_int64(rows.get(), 1));
    }
  }

  static std::string text(const Statement& row, int column) {
    const auto* value = sqlite3_column_text(row.get(), column);
    return value == nullptr ? "" : printable(reinterpret_cast<const char*>(value));
  }

  /// The message of the current row; nullopt, and counted, if it is damaged.
  std::optional<BagMessage> current() {
    last_row_ = sqlite3_column_int64(messages_.get(), 3);
    const auto topic = topics_.find(sqlite3_column_int64(messages_.get(), 0));
    if (topic == topics_.end()) return std::nullopt;
    const auto* data = static_cast<const uint8_t*>(sqlite3_column_blob(messages_.get(), 2));
    Bytes bytes(data, static_cast<size_t>(sqlite3_column_bytes(messages_.get(), 2)));
    if (data == nullptr) bytes = {};
    try {
      if (is_zstd(bytes)) {
        decompressed_ = decompressed_zstd_message(bytes);
        bytes = decompressed_;
      }
    } catch (const InputError& error) {
      report(fmt::format("a message is skipped: {}", error.what()));
      return std::nullopt;
    }
    return BagMessage{&topic->second, sqlite3_column_int64(messages_.get(), 1), bytes};
  }

  std::string name_;
  Database database_;
  Statement messages_;    ///< closed before the database
  int64_t last_row_ = 0;  ///< rows of damaged pages may come again
  std::map<int64_t, BagTopic> topics_;
  std::vector<uint8_t> decompressed_;
  SkippedFrames damage_;
};

}  // namespace

std::unique_ptr<MessageFile> open_sqlite_bag(const std::filesystem::path& path) {
  return std::make_unique<SqliteBag>(path);
}

}  // namespace kinloop
