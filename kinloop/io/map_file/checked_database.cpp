#include "kinloop/io/map_file/checked_database.hpp"

#include <limits>

#include <fmt/format.h>
#include <libdeflate.h>
#include <sqlite3.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/untrusted_database.hpp"

namespace kinloop {
namespace {

uint32_t extend(uint32_t sum, const void* bytes, size_t count) {
  return libdeflate_crc32(sum, bytes, count);
}

uint32_t extend(uint32_t sum, uint64_t number) {
  return extend(sum, &number, sizeof number);
}

/// CRC-32 over a row, including its table and id.
int64_t checksum(const std::string& table, int64_t id, const Row& row) {
  uint32_t sum = extend(0, table.data(), table.size());
  sum = extend(sum, static_cast<uint64_t>(id));
  for (const Cell& cell : row) {
    sum = extend(sum, cell.index());
    if (const auto* integer = std::get_if<int64_t>(&cell)) {
      sum = extend(sum, integer, sizeof *integer);
    } else if (const auto* real = std::get_if<double>(&cell)) {
      sum = extend(sum, real, sizeof *real);
    } else {
      const auto* blob = std::get_if<Blob>(&cell);
      const std::string& bytes = blob != nullptr ? blob->bytes : std::get<std::string>(cell);
      sum = extend(extend(sum, bytes.size()), bytes.data(), bytes.size());
    }
  }
  return sum;
}

void bind(sqlite3_stmt* statement, int place, const Cell& cell) {
  // The row outlives the step that reads the bound values, so nothing is copied.
  if (const auto* integer = std::get_if<int64_t>(&cell)) {
    sqlite3_bind_int64(statement, place, *integer);
  } else if (const auto* real = std::get_if<double>(&cell)) {
    sqlite3_bind_double(statement, place, *real);
  } else if (const auto* text = std::get_if<std::string>(&cell)) {
    sqlite3_bind_text64(statement, place, text->data(), text->size(), SQLITE_STATIC, SQLITE_UTF8);
  } else {
    const std::string& bytes = std::get<Blob>(cell).bytes;
    sqlite3_bind_blob64(statement, place, bytes.data(), bytes.size(), SQLITE_STATIC);
  }
}

std::string column_bytes(sqlite3_stmt* statement, int column) {
  const void* bytes = sqlite3_column_blob(statement, column);
  const auto count = static_cast<size_t>(sqlite3_column_bytes(statement, column));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), count);
}

Cell cell_of(sqlite3_stmt* statement, int column) {
  switch (sqlite3_column_type(statement, column)) {
    case SQLITE_INTEGER:
      return static_cast<int64_t>(sqlite3_column_int64(statement, column));
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement, column);
    case SQLITE_TEXT:
      return column_bytes(statement, column);
    default:
      return Blob{column_bytes(statement, column)};
  }
}

/// Formats a path as an SQLite URI. With an authority, which is empty, as "//" could begin the path.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(path).string()) {
    const bool special = c == '?' || c == '#' || c == '%';
    uri += special ? fmt::format("%{:02x}", static_cast<unsigned char>(c)) : std::string(1, c);
  }
  return uri + "?immutable=1";
}

}  // namespace

void CloseDatabase::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

void FinalizeStatement::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

DatabaseWriter::DatabaseWriter(std::filesystem::path path, const DatabaseFormat& kind)
    : file_(std::move(path)) {
  sqlite3* database = nullptr;
  // No other process knows the file, so none of SQLite's locks are needed.
  const int opened = sqlite3_open_v2(file_.temporary().c_str(), &database,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, "unix-none");
  database_.reset(database);
  if (opened != SQLITE_OK) fail();
  // A crash only leaves a temporary file behind, so no journal is needed; OutputFile flushes to the disk.
  execute(
      "PRAGMA page_size=16384; PRAGMA journal_mode=OFF; PRAGMA locking_mode=EXCLUSIVE; PRAGMA "
      "synchronous=OFF");
  execute(fmt::format("PRAGMA application_id={}; PRAGMA user_version={}", kind.application, kind.version));
  execute("BEGIN");
}

void DatabaseWriter::create(const std::string& table, const std::vector<std::string>& columns) {
  // Columns without a type keep values as given.
  std::string names, places = "?";
  for (const std::string& column : columns) {
    names += ", " + column;
    places += ", ?";
  }
  execute(fmt::format("CREATE TABLE {} (id INTEGER PRIMARY KEY{}, checksum)", table, names));
  sqlite3_stmt* statement = nullptr;
  const std::string sql = fmt::format("INSERT INTO {} VALUES ({}, ?)", table, places);
  if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) fail();
  inserts_[table].reset(statement);
}

void DatabaseWriter::insert(const std::string& table, int64_t id, const Row& row) {
  sqlite3_stmt* statement = inserts_.at(table).get();
  sqlite3_bind_int64(statement, 1, id);
  for (size_t i = 0; i < row.size(); ++i) bind(statement, static_cast<int>(i) + 2, row[i]);
  sqlite3_bind_int64(statement, static_cast<int>(row.size()) + 2, checksum(table, id, row));
  if (sqlite3_step(statement) != SQLITE_DONE) fail();
  sqlite3_reset(statement);
}

void DatabaseWriter::commit() {
  execute("COMMIT");
  inserts_.clear();
  database_.reset();
  file_.commit();
}

void DatabaseWriter::execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void DatabaseWriter::fail() const {
  throw OutputError(
      fmt::format("{}: cannot be written ({}); check that the folder is writable and the disk is not full",
                  file_.path().string(), sqlite3_errmsg(database_.get())));
}

DatabaseReader::DatabaseReader(std::filesystem::path path, const DatabaseFormat& kind)
    : path_(std::move(path)) {
  if (!std::filesystem::is_regular_file(path_)) {
    throw InputError(fmt::format("{}: no such file; check the path", path_.string()));
  }
  sqlite3* database = nullptr;
  const int opened =
      sqlite3_open_v2(uri_of(path_).c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  database_.reset(database);
  if (opened != SQLITE_OK) throw InputError(fmt::format("{}: cannot be opened", path_.string()));
  // With a writable schema SQLite reads a file that is shorter than its header says, as far as possible.
  sqlite3_exec(database, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
  set_untrusted(database, std::filesystem::file_size(path_), std::numeric_limits<int>::max());
  if (pragma("application_id") != kind.application) {
    throw InputError(fmt::format(
        "{}: not a kinloop map, or damaged at its beginning; give the map.kinmap of a run", path_.string()));
  }
  const int64_t version = pragma("user_version");
  if (version < 1) {
    throw InputError(
        fmt::format("{}: has format {}, which does not exist: the file is damaged; copy it again",
                    path_.string(), version));
  }
  if (version > kind.version) {
    throw InputError(fmt::format("{}: has format {}, newer than the supported {}; use a newer kinloop",
                                 path_.string(), version, kind.version));
  }
}

TableDamage DatabaseReader::read(const std::string& table,
                                 const std::function<bool(int64_t id, const Row& row)>& take) const {
  const Statement statement = prepare(fmt::format("SELECT * FROM {} ORDER BY id", table));
  if (!statement) return {0, true};
  TableDamage damage;
  const int columns = sqlite3_column_count(statement.get());
  int64_t last_id = std::numeric_limits<int64_t>::min();
  int state = SQLITE_ROW;
  while ((state = sqlite3_step(statement.get())) == SQLITE_ROW) {
    const int64_t id = sqlite3_column_int64(statement.get(), 0);
    // Damaged pages can form a cycle; ids then decrease.
    if (id <= last_id) return {damage.rows, true};
    last_id = id;
    Row row;
    for (int column = 1; column + 1 < columns; ++column) row.push_back(cell_of(statement.get(), column));
    const bool whole = sqlite3_column_int64(statement.get(), columns - 1) == checksum(table, id, row);
    if (!whole || !take(id, row)) ++damage.rows;
  }
  damage.truncated = state != SQLITE_DONE;
  return damage;
}

Statement DatabaseReader::prepare(const std::string& sql) const {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &statement, nullptr);
  return Statement(statement);
}

int64_t DatabaseReader::pragma(const std::string& name) const {
  const Statement statement = prepare("PRAGMA " + name);
  if (!statement || sqlite3_step(statement.get()) != SQLITE_ROW) return 0;
  return sqlite3_column_int64(statement.get(), 0);
}

}  // namespace kinloop
