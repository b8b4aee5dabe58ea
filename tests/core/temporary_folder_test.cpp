#include "kinloop/core/files/temporary_folder.hpp"

#include <chrono>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

class TemporaryFolderTest : public testing::Test {
 protected:
  /// Waits, since the shell that removes the folder of a process notices its end a moment later.
  [[nodiscard]] bool becomes_empty() const {
    constexpr int kLooks = 1000;
    constexpr std::chrono::milliseconds kBetweenLooks{10};
    for (int i = 0; i < kLooks && !fs::is_empty(place_.path()); ++i)
      std::this_thread::sleep_for(kBetweenLooks);
    return fs::is_empty(place_.path());
  }

  const test::TempFolder place_;
  const test::EnvironmentVariable tmpdir_{"TMPDIR", place_.path().string()};
};

TEST_F(TemporaryFolderTest, IsRemovedWithItsFiles) {
  fs::path path;
  {
    const TemporaryFolder folder;
    path = folder.path();
    EXPECT_EQ(path.parent_path(), place_.path());
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    fs::create_directories(path / "a/b");
    write_file(path / "a/b/file", "content");
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(TemporaryFolderTest, IsRemovedAfterAKilledProcess) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const TemporaryFolder folder;
    write_file(folder.path() / "a file", "content");
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(becomes_empty());
}

TEST_F(TemporaryFolderTest, OutlivesACopyOfTheProcess) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    folder.~TemporaryFolder();
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(folder.path()));
}

TEST(TemporaryFolder, NamesTheVariableWhereNoneCanBeMade) {
  const test::EnvironmentVariable nowhere("TMPDIR", "/nonexistent");
  EXPECT_THAT(test::input_error([] { const TemporaryFolder folder; }), testing::HasSubstr("set TMPDIR"));
}

}  // namespace
}  // namespace kinloop
