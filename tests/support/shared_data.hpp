#pragma once
// Test data. Real recordings are in ../shared/data next to the project; tests that need them are skipped,
// with a message, if they are missing.

#include <filesystem>

#include <gtest/gtest.h>

namespace kinloop::test {

/// Returns the root of the source tree.
std::filesystem::path source_folder();

/// Returns the path of `name` in the shared data, whether it exists or not.
std::filesystem::path shared_data(const std::filesystem::path& name);

}  // namespace kinloop::test

/// Skips the test if the shared data lack `path`.
#define KINLOOP_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " not found: test skipped"
