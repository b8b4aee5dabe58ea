#include "kinloop/base/anonymous_temp_file.hpp"

#include <array>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

TEST(AnonymousTempFile, HoldsBytesAndLeavesNoTrace) {
  const test::TempFolder folder;
  const int file = open_anonymous_temp_file(folder.path());
  ASSERT_GE(file, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  ASSERT_EQ(pwrite(file, "abc", 3, 0), 3);
  std::array<char, 3> back{};
  ASSERT_EQ(pread(file, back.data(), back.size(), 0), 3);
  EXPECT_EQ(back[2], 'c');
  close(file);
}

TEST(AnonymousTempFile, WithoutAFolderThereIsNone) {
  const test::TempFolder folder;
  EXPECT_LT(open_anonymous_temp_file(folder.path() / "nowhere"), 0);
}

}  // namespace
}  // namespace kinloop
