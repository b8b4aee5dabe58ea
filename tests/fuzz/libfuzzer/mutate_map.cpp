#include "tests/fuzz/libfuzzer/mutate_map.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "kinloop/core/random.hpp"
#include "tests/fuzz/targets/map_rows.hpp"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace kinloop::fuzz {
namespace {

void mutate_bytes(std::string& bytes) {
  constexpr size_t kMoreBytes = 64;
  const size_t size = bytes.size();
  bytes.resize(size + kMoreBytes);
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(bytes.data()), size, bytes.size()));
}

int64_t mutated(int64_t value, Random& random) {
  constexpr auto kNotable = std::to_array<int64_t>(
      {0, 1, -1, 2, 255, 1 << 16, 60'000'000, std::numeric_limits<int32_t>::max(),
       std::numeric_limits<int32_t>::min(), std::numeric_limits<uint32_t>::max(), int64_t{1} << 32,
       std::numeric_limits<int64_t>::max(), std::numeric_limits<int64_t>::min()});
  switch (random.index(3)) {
    case 0:
      return kNotable[random.index(kNotable.size())];
    case 1:
      return static_cast<int64_t>(static_cast<uint64_t>(value) + random.index(8) - 4);
    default:
      return static_cast<int64_t>(static_cast<uint64_t>(value) ^ uint64_t{1} << random.index(64));
  }
}

double mutated(double value, Random& random) {
  using Limits = std::numeric_limits<double>;
  constexpr auto kNotable = std::to_array<double>({0, -0.0, 1, -1, 1e-300, 1e9, 1e300, Limits::infinity(),
                                                   -Limits::infinity(), Limits::max(), Limits::denorm_min()});
  if (random.index(2) == 0) return kNotable[random.index(kNotable.size())];
  LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(&value), sizeof value, sizeof value);
  return value;
}

/// The numbers inside of a blob are what its list of features or observations consists of.
void mutate_blob(std::string& bytes, Random& random) {
  constexpr size_t kNumber = sizeof(uint64_t);
  if (random.index(2) == 0 || bytes.size() < kNumber) return mutate_bytes(bytes);
  const size_t at = random.index(static_cast<uint32_t>(bytes.size() / 4)) * 4;
  if (at + kNumber > bytes.size()) return mutate_bytes(bytes);
  int64_t number = 0;
  std::memcpy(&number, &bytes[at], kNumber);
  number = mutated(number, random);
  std::memcpy(&bytes[at], &number, random.index(2) == 0 ? kNumber : kNumber / 2);
}

void mutate_cell(Cell& cell, Random& random) {
  constexpr uint32_t kOther = 16;
  if (random.index(kOther) == 0) {
    const std::array<Cell, 4> cells = {int64_t{0}, 0.0, std::string("text"), Blob{"blob"}};
    cell = cells[random.index(cells.size())];
  } else if (auto* integer = std::get_if<int64_t>(&cell)) {
    *integer = mutated(*integer, random);
  } else if (auto* real = std::get_if<double>(&cell)) {
    *real = mutated(*real, random);
  } else if (auto* blob = std::get_if<Blob>(&cell)) {
    mutate_blob(blob->bytes, random);
  } else {
    mutate_bytes(std::get<std::string>(cell));
  }
}

void mutate_rows(std::vector<MapRow>& rows, Random& random) {
  const auto any = [&] { return random.index(static_cast<uint32_t>(rows.size())); };
  const uint32_t row = any();
  switch (random.index(8)) {
    case 0:
      rows.erase(rows.begin() + row);
      break;
    case 1:
      rows[row].id = mutated(rows[row].id, random);
      break;
    case 2:
      rows.push_back(rows[row]);
      rows.back().id = mutated(rows[row].id, random);
      break;
    case 3:
      rows[row].cells = rows[any()].cells;
      break;
    default:
      if (rows[row].cells.empty()) break;
      mutate_cell(rows[row].cells[random.index(static_cast<uint32_t>(rows[row].cells.size()))], random);
  }
}

}  // namespace

size_t mutate_map(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  std::vector<MapRow> rows = rows_of({reinterpret_cast<const char*>(data), size});
  Random random(seed);
  for (uint32_t i = 0; i <= random.index(3) && !rows.empty(); ++i) mutate_rows(rows, random);
  const std::string bytes = to_bytes(rows);
  if (bytes.empty() || bytes.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

}  // namespace kinloop::fuzz
