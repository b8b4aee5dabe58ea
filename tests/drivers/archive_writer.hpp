#pragma once
// Archives for tests: proper ones of a folder, and tar archives whose members are what a test wants.

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace kinloop::test {

/// A member of a tar archive (ustar). `type` is '0': a file, '1' and '2': links, '3': a device, '5': a
/// folder. `stated_size` may differ from that of the content.
inline std::string tar_member(std::string_view name, std::string_view content, char type = '0',
                              std::string_view link = {}, long long stated_size = -1) {
  constexpr size_t kBlock = 512, kName = 0, kMode = 100, kSize = 124, kTime = 136, kSum = 148, kType = 156,
                   kLink = 157, kMagic = 257;
  std::string header(kBlock, '\0');
  const auto put = [&](size_t at, std::string_view text) { header.replace(at, text.size(), text); };
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "%011llo",
                stated_size < 0 ? static_cast<long long>(content.size()) : stated_size);
  put(kName, name);
  put(kMode, "0000000");  // nobody may read it
  put(kSize, number.data());
  put(kTime, "00000000000");
  put(kSum, "        ");
  header[kType] = type;
  put(kLink, link);
  put(kMagic, std::string_view("ustar\00000", 8));
  unsigned sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  std::snprintf(number.data(), number.size(), "%06o", sum);
  put(kSum, number.data());
  std::string member = header + std::string(content);
  member.resize((member.size() + kBlock - 1) / kBlock * kBlock);
  return member;
}

/// What ends a tar archive.
inline std::string tar_end() {
  return std::string(1024, '\0');
}

}  // namespace kinloop::test
