#include <cstdint>

#include "viewer/point_files/point_formats.hpp"

namespace kinloop {

std::optional<std::string> decompress_lzf(std::string_view compressed, size_t size) {
  constexpr size_t kMaxExpansion = 88;  // three bytes encode at most 264; limits memory for a corrupt size
  if (size / kMaxExpansion > compressed.size()) return std::nullopt;
  constexpr size_t kLiterals = 32, kLongMatch = 7, kShortestMatch = 2;
  std::string bytes;
  bytes.reserve(size);
  size_t at = 0;
  const auto next = [&] { return at < compressed.size() ? static_cast<uint8_t>(compressed[at++]) : 0U; };
  while (at < compressed.size()) {
    const size_t control = next();
    if (control < kLiterals) {  // control + 1 literal bytes
      const size_t count = control + 1;
      if (count > compressed.size() - at || count > size - bytes.size()) return std::nullopt;
      bytes.append(compressed.substr(at, count));
      at += count;
      continue;
    }
    size_t length = control >> 5;  // back reference: length and distance
    if (length == kLongMatch) length += next();
    length += kShortestMatch;
    const size_t back = ((control & 31) << 8) + next() + 1;
    if (back > bytes.size() || length > size - bytes.size()) return std::nullopt;
    for (size_t i = 0; i < length; ++i) bytes.push_back(bytes[bytes.size() - back]);
  }
  if (bytes.size() != size) return std::nullopt;
  return bytes;
}

}  // namespace kinloop
