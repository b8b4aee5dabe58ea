#pragma once
// SQLite on a file that may come from anywhere: it runs no code of its own, and neither a value nor the time
// of a statement exceeds what the size of the file explains.

#include <algorithm>
#include <cstdint>
#include <limits>

#include <sqlite3.h>

namespace kinloop {

/// Sets the limits. Views and triggers are refused: a view can be endless. Damaged pages can form a tree of
/// any size, so a statement is interrupted after a number of instructions that grows with the file.
inline void set_untrusted(sqlite3* database, uint64_t file_bytes, uint64_t max_value_bytes) {
  constexpr uint64_t kPageBytes = 4096, kInstructions = 1'000'000, kInstructionsPerByte = 8,
                     kMax = std::numeric_limits<int>::max();
  const uint64_t value_bytes = std::clamp(file_bytes, kPageBytes, std::min(max_value_bytes, kMax));
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(value_bytes));
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_exec(database, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
  const uint64_t bytes = std::min(file_bytes, kMax / kInstructionsPerByte - kInstructions);
  const auto instructions = static_cast<int>(kInstructions + kInstructionsPerByte * bytes);
  sqlite3_progress_handler(
      database, instructions, [](void*) { return 1; }, nullptr);
}

}  // namespace kinloop
