#pragma once
// Tables in one SQLite file that notices damage: every row carries a checksum, and a file that lost its end,
// or whose bytes were altered, still gives the rows that are whole.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace kinloop {

/// Bytes that are not text.
struct Blob {
  std::string bytes;

  bool operator==(const Blob&) const = default;
};

/// One value of a row; numbers come back to the last bit, but must not be NaN.
using Cell = std::variant<int64_t, double, std::string, Blob>;
using Row = std::vector<Cell>;

/// Takes the cells of a row one by one; once one is missing or of another kind, nothing but zeros.
class RowReader {
 public:
  explicit RowReader(const Row& row) : row_(row) {}

  template <class T>
  T take() {
    const T* cell = next_ < row_.size() ? std::get_if<T>(&row_[next_]) : nullptr;
    ++next_;
    if (cell == nullptr) type_mismatch_ = true;
    return cell != nullptr ? *cell : T{};
  }

  /// Whether every cell was there and none is left.
  [[nodiscard]] bool exhausted() const { return !type_mismatch_ && next_ == row_.size(); }

 private:
  const Row& row_;
  size_t next_ = 0;
  bool type_mismatch_ = false;
};

/// What a file says it is.
struct DatabaseFormat {
  int32_t application = 0;  ///< four letters that tell this kind of file from others
  int32_t version = 0;      ///< of its format
};

struct CloseDatabase {
  void operator()(sqlite3* database) const;
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const;
};
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

/// Writes a file beside `path` that takes its name only when it is complete.
class DatabaseWriter {
 public:
  /// Throws InputError when the file cannot be made.
  DatabaseWriter(std::filesystem::path path, const DatabaseFormat& kind);
  ~DatabaseWriter();
  DatabaseWriter(const DatabaseWriter&) = delete;
  DatabaseWriter& operator=(const DatabaseWriter&) = delete;

  /// Makes a table with these columns, beside an id and the checksum.
  void create(const std::string& table, const std::vector<std::string>& columns);

  /// Adds a row. The ids of a table must grow.
  void insert(const std::string& table, int64_t id, const Row& row);

  /// Brings everything to the disk and renames. Throws InputError when that fails.
  void commit();

 private:
  void execute(const std::string& sql);
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  std::map<std::string, Statement> inserts_;  // by table
  bool committed_ = false;
};

/// What was not found whole.
struct TableDamage {
  size_t rows = 0;         ///< whose checksum is wrong, or which are not what they should be
  bool truncated = false;  ///< the rest of the table cannot be reached

  [[nodiscard]] bool any() const { return rows > 0 || truncated; }
};

/// Reads such a file; changes nothing, not even beside it.
class DatabaseReader {
 public:
  /// Throws InputError, which begins with the path, for what is no such file, or one of a newer version.
  DatabaseReader(std::filesystem::path path, const DatabaseFormat& kind);

  /// Gives the whole rows of a table in the order of their ids to `take`, which says whether a row is what it
  /// should be.
  TableDamage read(const std::string& table,
                   const std::function<bool(int64_t id, const Row& row)>& take) const;

 private:
  [[nodiscard]] Statement prepare(const std::string& sql) const;
  [[nodiscard]] int64_t pragma(const std::string& name) const;

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
};

}  // namespace kinloop
