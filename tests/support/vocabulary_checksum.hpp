#pragma once
// The checksum of vocabulary files as described in docs/method.md, implemented independently.

#include <bit>
#include <cstdint>
#include <string>

namespace kinloop::test {

/// Returns the bytes of a vocabulary file with the right checksum.
inline std::string with_vocabulary_checksum(std::string bytes) {
  constexpr size_t kHeaderBytes = 48, kChecksumOffset = 40;
  if (bytes.size() < kHeaderBytes) return bytes;
  const auto word_at = [&](size_t at) {
    uint64_t word = 0;
    for (size_t i = 0; i < 8; ++i) word |= uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return word;
  };
  const auto step = [](uint64_t sum, uint64_t word) { return std::rotl((sum ^ word) * 0x100000001b3, 29); };
  uint64_t sum = 0xcbf29ce484222325, lanes[4] = {sum, sum, sum, sum};
  const auto add = [&](size_t begin, size_t end) {
    for (size_t i = 0; begin + 8 * i + 8 <= end; ++i)
      lanes[i % 4] = step(lanes[i % 4], word_at(begin + 8 * i));
  };
  add(0, kChecksumOffset);
  add(kHeaderBytes, bytes.size());
  for (const uint64_t lane : lanes) sum = step(sum, lane);
  for (size_t i = 0; i < 8; ++i) bytes[kChecksumOffset + i] = static_cast<char>(sum >> (8 * i));
  return bytes;
}

}  // namespace kinloop::test
