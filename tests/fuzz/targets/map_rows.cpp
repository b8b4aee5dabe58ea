#include "tests/fuzz/targets/map_rows.hpp"

#include <array>
#include <map>

#include <fmt/format.h>

#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/io/map_file/map_tables.hpp"

namespace kinloop::fuzz {
namespace {

struct MapTable {
  const char* name;
  size_t columns;  ///< without id and checksum
};

namespace tables = map_tables;
constexpr auto kTables = std::to_array<MapTable>({{tables::kAbout, 2},
                                                  {tables::kSession, 2},
                                                  {tables::kOption, 2},
                                                  {tables::kCamera, 2},
                                                  {tables::kSensor, 3},
                                                  {tables::kKeyframe, 12},
                                                  {tables::kLoopEdge, 11},
                                                  {tables::kLandmark, 5},
                                                  {tables::kFrame, 14},
                                                  {tables::kImage, 5}});

std::string text_from(ValueReader& reader) {
  const auto values = reader.list<char>();
  return {values.begin(), values.end()};
}

Cell cell_from(ValueReader& reader) {
  switch (reader.value<uint8_t>() % 4) {
    case 0:
      return reader.value<int64_t>();
    case 1:
      return reader.value<double>();
    case 2:
      return text_from(reader);
    default:
      return Blob{text_from(reader)};
  }
}

void put_cell(std::string& bytes, const Cell& cell) {
  bytes += static_cast<char>(cell.index());
  if (const auto* integer = std::get_if<int64_t>(&cell)) return put_values(bytes, integer, 1);
  if (const auto* real = std::get_if<double>(&cell)) return put_values(bytes, real, 1);
  const auto* blob = std::get_if<Blob>(&cell);
  const std::string& text = blob != nullptr ? blob->bytes : std::get<std::string>(cell);
  const uint64_t size = text.size();
  put_values(bytes, &size, 1);
  bytes += text;
}

}  // namespace

std::vector<MapRow> rows_of(std::string_view bytes) {
  constexpr size_t kMaxRows = 1000;
  std::vector<MapRow> rows;
  ValueReader reader(bytes);
  while (rows.size() < kMaxRows) {
    MapRow row;
    row.table = static_cast<uint8_t>(reader.value<uint8_t>() % kTables.size());
    row.id = reader.value<int64_t>();
    const size_t cells = reader.value<uint8_t>() % 16;
    for (size_t i = 0; i < cells; ++i) row.cells.push_back(cell_from(reader));
    if (reader.truncated()) break;
    rows.push_back(std::move(row));
    if (reader.exhausted()) break;
  }
  return rows;
}

std::string to_bytes(const std::vector<MapRow>& rows) {
  std::string bytes;
  for (const MapRow& row : rows) {
    bytes += static_cast<char>(row.table);
    put_values(bytes, &row.id, 1);
    bytes += static_cast<char>(row.cells.size());
    for (const Cell& cell : row.cells) put_cell(bytes, cell);
  }
  return bytes;
}

void write_rows(const std::filesystem::path& path, const std::vector<MapRow>& rows) {
  std::array<std::map<int64_t, Row>, kTables.size()> content;
  for (const MapRow& row : rows) content[row.table % kTables.size()][row.id] = row.cells;
  DatabaseWriter file(path, tables::kKind);
  for (size_t table = 0; table < kTables.size(); ++table) {
    const auto [name, columns] = kTables[table];
    std::vector<std::string> names;
    for (size_t i = 0; i < columns; ++i) names.push_back(fmt::format("c{}", i));
    file.create(name, names);
    for (auto& [id, cells] : content[table]) {
      cells.resize(columns, int64_t{0});
      file.insert(name, id, cells);
    }
  }
  file.commit();
}

std::vector<MapRow> read_rows(const std::filesystem::path& path) {
  std::vector<MapRow> rows;
  const DatabaseReader file(path, tables::kKind);
  for (size_t table = 0; table < kTables.size(); ++table) {
    file.read(kTables[table].name, [&](int64_t id, const Row& cells) {
      rows.push_back({static_cast<uint8_t>(table), id, cells});
      return true;
    });
  }
  return rows;
}

}  // namespace kinloop::fuzz
