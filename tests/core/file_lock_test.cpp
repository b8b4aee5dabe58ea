#include "kinloop/core/files/file_lock.hpp"

#include <optional>

#include <gmock/gmock.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(FileLock, ASecondHolderOfAFileIsRefusedUntilTheFirstEnds) {
  const test::TempFolder folder;
  const auto file = folder.path() / "map.kinmap";
  std::optional<FileLock> first(std::in_place, file);
  EXPECT_THAT(test::input_error([&] { const FileLock second(file); }),
              AllOf(HasSubstr(file.string()), HasSubstr("another run"), HasSubstr("--save-map")));
  const FileLock other(folder.path() / "other.kinmap");
  first.reset();
  const FileLock again(file);
}

TEST(FileLock, ALinkToTheFileIsTheSameFile) {
  const test::TempFolder folder;
  const auto file = folder.write("map.kinmap", "map");
  std::filesystem::create_symlink(file, folder.path() / "link");
  const FileLock first(file);
  EXPECT_THAT(test::input_error([&] { const FileLock second(folder.path() / "link"); }), HasSubstr("link"));
}

TEST(FileLock, NothingIsLeftBehind) {
  const test::TempFolder folder;
  { const FileLock lock(folder.path() / std::string(255, 'm')); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace kinloop
