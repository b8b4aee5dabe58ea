#pragma once
// The rows of a map file as plain bytes, so that a fuzzer changes values and not checksums.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kinloop/io/map_file/checked_database.hpp"

namespace kinloop::fuzz {

struct MapRow {
  uint8_t table = 0;  ///< index among the tables of a map file
  int64_t id = 0;
  Row cells;
};

/// Parses rows up to the first that is incomplete.
std::vector<MapRow> rows_of(std::string_view bytes);
std::string to_bytes(const std::vector<MapRow>& rows);

/// Writes a map file of these rows with right checksums. Of rows with the same id the last one counts;
/// missing cells become 0.
void write_rows(const std::filesystem::path& path, const std::vector<MapRow>& rows);

/// Reads the rows of an intact map file.
std::vector<MapRow> read_rows(const std::filesystem::path& path);

}  // namespace kinloop::fuzz
