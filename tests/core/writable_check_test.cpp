#include "kinloop/core/files/writable_check.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

std::string error_of(const fs::path& path) {
  return input_error([&] { require_writable_file(path); });
}

TEST(RequireWritable, MakesTheFoldersAndLeavesNothingElse) {
  const TempFolder folder;
  require_writable_file(folder.path() / "a/b/c.txt");
  EXPECT_TRUE(fs::is_empty(folder.path() / "a/b"));
  require_writable_folder(folder.path() / "d/e");
  EXPECT_TRUE(fs::is_empty(folder.path() / "d/e"));
  EXPECT_NO_THROW(require_writable_file("")) << "an output that was not requested";
}

TEST(RequireWritable, KeepsAFileThatIsThere) {
  const TempFolder folder;
  const auto path = folder.write("old.txt", "old");
  require_writable_file(path);
  EXPECT_EQ(fs::file_size(path), 3U);
}

TEST(RequireWritable, SaysWhyNot) {
  const TempFolder folder;
  folder.write("file", "");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("is a folder; give the name of a file in it"));
  EXPECT_THAT(error_of(folder.path() / "new" / ""), HasSubstr("is a folder"));
  EXPECT_THAT(error_of(folder.path() / "file/x"),
              AllOf(HasSubstr("file"), HasSubstr("another output folder")));
  EXPECT_THAT(error_of("/proc/x"), AllOf(HasSubstr("/proc"), HasSubstr("another output folder")));
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_NO_THROW(require_writable_file(folder.path() / "pipe")) << "written through, see OutputFile";
}

}  // namespace
}  // namespace kinloop
