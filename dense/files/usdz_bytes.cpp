#include <cstdint>
#include <utility>

#include <libdeflate.h>

#include "dense/files/mesh_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"

namespace kinloop {
namespace {

constexpr size_t kAlignment = 64;
constexpr size_t kLocalHeaderBytes = 30, kExtraHeaderBytes = 4;

void put_u16(std::string& bytes, size_t number) {
  const auto value = static_cast<uint16_t>(number);
  put_values(bytes, &value, 1);
}

void put_u32(std::string& bytes, size_t number) {
  const auto value = static_cast<uint32_t>(number);
  put_values(bytes, &value, 1);
}

/// What the header before a file and its entry in the directory have in common.
void put_description(std::string& bytes, const PackagedFile& file, size_t extra_bytes) {
  constexpr size_t kVersion = 10, kFirstDay = 1 << 5 | 1;  // 1980-01-01: the same input gives the same bytes
  for (const size_t field : {kVersion, size_t{0}, size_t{0}, size_t{0}, kFirstDay}) put_u16(bytes, field);
  put_u32(bytes, libdeflate_crc32(0, file.bytes.data(), file.bytes.size()));
  for (int size = 0; size < 2; ++size) put_u32(bytes, file.bytes.size());  // compressed or not
  put_u16(bytes, file.name.size());
  put_u16(bytes, extra_bytes);
}

/// The bytes, at least as many as an extra field needs, that align what follows the header of a file.
size_t padding_at(size_t header, const PackagedFile& file) {
  const size_t end = header + kLocalHeaderBytes + file.name.size() + kExtraHeaderBytes;
  return kExtraHeaderBytes + (kAlignment - end % kAlignment) % kAlignment;
}

void put_file(std::string& bytes, const PackagedFile& file) {
  constexpr size_t kUnknownField = 0x1986;  // as the USD library writes
  const size_t padding = padding_at(bytes.size(), file);
  bytes += "PK\3\4";
  put_description(bytes, file, padding);
  bytes += file.name;
  put_u16(bytes, kUnknownField);
  put_u16(bytes, padding - kExtraHeaderBytes);
  bytes.append(padding - kExtraHeaderBytes, '\0');
  bytes += file.bytes;
}

/// The entry in the directory of a file whose header begins at `offset`.
void put_entry(std::string& bytes, const PackagedFile& file, size_t offset) {
  bytes += "PK\1\2";
  put_u16(bytes, 10);  // made by version 1.0, as is needed
  put_description(bytes, file, 0);
  for (int field = 0; field < 3; ++field) put_u16(bytes, 0);  // comment, disk, kind
  put_u32(bytes, 0);                                          // attributes
  put_u32(bytes, offset);
  bytes += file.name;
}

}  // namespace

std::string usdz_bytes(std::span<const PackagedFile> files) {
  std::string bytes, directory;
  for (const PackagedFile& file : files) {
    put_entry(directory, file, bytes.size());
    put_file(bytes, file);
    require(std::in_range<uint32_t>(bytes.size()), "usdz_bytes: more than 4 GiB");
  }
  const size_t begin = bytes.size();
  bytes += directory;
  bytes += "PK\5\6";
  for (int disk = 0; disk < 2; ++disk) put_u16(bytes, 0);
  for (int count = 0; count < 2; ++count) put_u16(bytes, files.size());
  put_u32(bytes, directory.size());
  put_u32(bytes, begin);
  put_u16(bytes, 0);  // no comment
  return bytes;
}

}  // namespace kinloop
