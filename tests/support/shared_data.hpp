#pragma once
// Real recordings, where they are: ../shared/data beside the project. Tests that need them skip, saying so.

#include <filesystem>

#include <gtest/gtest.h>

namespace kinloop::test {

/// Where `name` of the shared data lies, or would lie.
inline std::filesystem::path shared_data(const std::filesystem::path& name) {
  return std::filesystem::path(KINLOOP_SHARED_DATA) / name;
}

}  // namespace kinloop::test

/// Ends the test as skipped where the shared data lack `path`.
#define KINLOOP_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " is absent: nothing to test with"
