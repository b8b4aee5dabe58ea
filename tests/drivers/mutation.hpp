#pragma once
// Damaged files for readers, the same in every run.

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>

#include "drivers/ros/bag_source.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"

namespace kinloop::test {

/// Returns how many damaged files a test tries: `usual`, or the number in KINLOOP_MUTATIONS.
inline int mutations(int usual) {
  const char* wanted = std::getenv("KINLOOP_MUTATIONS");
  return wanted == nullptr ? usual : std::atoi(wanted);
}

/// Changes, removes or repeats a few bytes.
inline std::string mutated(std::string bytes, Random& random) {
  const uint32_t changes = 1 + random.index(4);
  for (uint32_t i = 0; i < changes && !bytes.empty(); ++i) {
    const size_t at = random.index(static_cast<uint32_t>(bytes.size()));
    switch (random.index(4)) {
      case 0:
        bytes[at] = static_cast<char>(random.next());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.index(8)));
        break;
      case 2:
        bytes.erase(at, 1 + random.index(16));
        break;
      default:
        bytes.insert(at, bytes.substr(at, 1 + random.index(16)));
    }
  }
  return bytes;
}

/// Reads everything, and removes the file; only InputError may be thrown.
inline void read_all(const std::filesystem::path& path) {
  try {
    const auto source = open_bag(path, {});
    while (source->next()) {
    }
    static_cast<void>(source->skipped());
  } catch (const InputError& error) {
    EXPECT_THAT(std::string(error.what()), testing::Not(testing::HasSubstr("\n")));
  }
  std::filesystem::remove(path);  // some file systems write a file that is overwritten to the disk at once
}

}  // namespace kinloop::test
