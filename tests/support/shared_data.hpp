#pragma once
// Files that tests read. Real recordings lie in ../shared/data beside the project; tests that need them skip
// without them, saying so.

#include <filesystem>

#include <gtest/gtest.h>

namespace kinloop::test {

/// The root of the source tree.
std::filesystem::path source_folder();

/// The path of `name` in the shared data, whether it exists or not.
std::filesystem::path shared_data(const std::filesystem::path& name);

}  // namespace kinloop::test

/// Ends the test as skipped where the shared data lack `path`.
#define KINLOOP_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " not found: test skipped"
