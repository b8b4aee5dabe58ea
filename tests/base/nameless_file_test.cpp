#include "kinloop/base/nameless_file.hpp"

#include <array>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

TEST(NamelessFile, HoldsBytesAndLeavesNoTrace) {
  const test::TempFolder folder;
  const int file = open_nameless_file(folder.path());
  ASSERT_GE(file, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  ASSERT_EQ(pwrite(file, "abc", 3, 0), 3);
  std::array<char, 3> back{};
  ASSERT_EQ(pread(file, back.data(), back.size(), 0), 3);
  EXPECT_EQ(back[2], 'c');
  close(file);
}

TEST(NamelessFile, WithoutAFolderThereIsNone) {
  const test::TempFolder folder;
  EXPECT_LT(open_nameless_file(folder.path() / "nowhere"), 0);
}

}  // namespace
}  // namespace kinloop
