#pragma once
// SQLite tables with damage detection: every row carries a checksum, and the intact rows of a truncated or
// altered file can still be read.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kinloop/core/files/output_file.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace kinloop {

/// Binary data.
struct Blob {
  std::string bytes;

  bool operator==(const Blob&) const = default;
};

/// One value of a row. Numbers are stored exactly but must not be NaN.
using Cell = std::variant<int64_t, double, std::string, Blob>;
using Row = std::vector<Cell>;

/// Reads the cells of a row one by one; returns zeros for those that are missing or of another type.
class RowReader {
 public:
  explicit RowReader(const Row& row) : row_(row) {}

  template <class T>
  T take() {
    const T* cell = next_ < row_.size() ? std::get_if<T>(&row_[next_]) : nullptr;
    ++next_;
    if (cell == nullptr) reject();
    return cell != nullptr ? *cell : T{};
  }

  /// Reads a number from `low` to `high`; any other is invalid.
  template <class Number>
  Number take_in(Number low, Number high) {
    const auto number = take<Number>();
    if (number >= low && number <= high) return number;
    reject();
    return low;
  }

  /// The row is invalid.
  void reject() { valid_ = false; }

  /// Returns whether every cell was present and valid and none is left.
  [[nodiscard]] bool exhausted() const { return valid_ && next_ == row_.size(); }

 private:
  const Row& row_;
  size_t next_ = 0;
  bool valid_ = true;
};

/// Application id and version in a file's header.
struct DatabaseFormat {
  int32_t application = 0;  ///< four letters that identify this type of file
  int32_t version = 0;      ///< format version
};

struct CloseDatabase {
  void operator()(sqlite3* database) const;
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const;
};
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

/// Writes such a file; it appears under its name once complete, see OutputFile.
class DatabaseWriter {
 public:
  /// Throws InputError if the file cannot be created.
  DatabaseWriter(std::filesystem::path path, const DatabaseFormat& kind);
  DatabaseWriter(const DatabaseWriter&) = delete;
  DatabaseWriter& operator=(const DatabaseWriter&) = delete;

  /// Creates a table with these columns, an id and the checksum.
  void create(const std::string& table, const std::vector<std::string>& columns);

  /// Adds a row. Ids must increase within a table.
  void insert(const std::string& table, int64_t id, const Row& row);

  /// Flushes everything to disk and renames. Throws InputError on failure.
  void commit();

 private:
  void execute(const std::string& sql);
  [[noreturn]] void fail() const;

  OutputFile file_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  std::map<std::string, Statement> inserts_;  // by table
};

/// The damage found in a table.
struct TableDamage {
  size_t rows = 0;         ///< rows with a wrong checksum or invalid content
  bool truncated = false;  ///< the rest of the table is unreadable

  [[nodiscard]] bool any() const { return rows > 0 || truncated; }
};

/// Reads such a file without modifying it or its folder.
class DatabaseReader {
 public:
  /// Throws InputError, beginning with the path, if the file is of another type or of a newer version.
  DatabaseReader(std::filesystem::path path, const DatabaseFormat& kind);

  /// Passes the intact rows of a table to `take` in order of id; `take` returns whether the row is valid.
  TableDamage read(const std::string& table,
                   const std::function<bool(int64_t id, const Row& row)>& take) const;

 private:
  [[nodiscard]] Statement prepare(const std::string& sql) const;
  [[nodiscard]] int64_t pragma(const std::string& name) const;

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
};

}  // namespace kinloop
