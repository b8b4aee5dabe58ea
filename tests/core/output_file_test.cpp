#include "kinloop/core/files/output_file.hpp"

#include <cstdlib>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kinloop/core/files/folder_lock.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/private_device.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

TEST(OutputFile, SymbolicLinksAreFollowed) {
  const TempFolder folder;
  folder.write("deep/old.txt", "old");
  fs::create_symlink("deep/old.txt", folder.path() / "link");
  fs::create_symlink(folder.path() / "link", folder.path() / "link_to_link");
  write_file(folder.path() / "link_to_link", "new");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link_to_link"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(read_file(folder.path() / "deep/old.txt"), "new");
}

TEST(OutputFile, ALinkToAFileThatDoesNotExistMakesTheFile) {
  const TempFolder folder;
  fs::create_directory(folder.path() / "deep");
  fs::create_symlink("deep/new.txt", folder.path() / "link");
  write_file(folder.path() / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(read_file(folder.path() / "deep/new.txt"), "new");
}

TEST(OutputFile, LinksInACircleAreAnError) {
  const TempFolder folder;
  fs::create_symlink("b", folder.path() / "a");
  fs::create_symlink("a", folder.path() / "b");
  EXPECT_THAT(input_error([&] { write_file(folder.path() / "a", "x"); }), HasSubstr("symbolic links"));
}

TEST(OutputFile, AReplacedFileKeepsItsModeAndOwner) {
  const TempFolder folder;
  const auto path = folder.write("out.txt", "old");
  constexpr mode_t kMode = 0640;
  constexpr uid_t kOther = 12345;
  ASSERT_EQ(chmod(path.c_str(), kMode), 0);
  const bool root = geteuid() == 0 && chown(path.c_str(), kOther, kOther) == 0;
  write_file(path, "new");
  struct stat file {};
  ASSERT_EQ(stat(path.c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777, kMode);
  if (root) {
    EXPECT_EQ(file.st_uid, kOther);
    EXPECT_EQ(file.st_gid, kOther);
  }
}

TEST(OutputFile, ANewFileHasTheModeOfTheUmask) {
  const TempFolder folder;
  const mode_t before = umask(027);
  write_file(folder.path() / "out.txt", "new");
  umask(before);
  struct stat file {};
  ASSERT_EQ(stat((folder.path() / "out.txt").c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777, 0640U);
}

TEST(OutputFile, APipeIsWrittenThrough) {
  const TempFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string content(1'000'000, 'x');
  std::string received;
  std::jthread reader([&] {
    std::ifstream stream(pipe, std::ios::binary);
    received.assign(std::istreambuf_iterator<char>(stream), {});
  });
  write_file(pipe, content);
  reader.join();
  EXPECT_TRUE(received == content);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(OutputFile, ADeviceIsWrittenThroughAndItsErrorsAreReported) {
  const TempFolder folder;
  const auto device = test::private_full_device(folder);
  if (device.empty()) GTEST_SKIP() << "only root may create a device, and only where devices are allowed";
  EXPECT_THAT(input_error([&] { write_file(device, "x"); }),
              AllOf(HasSubstr("full"), HasSubstr("is the disk full")));
  EXPECT_TRUE(fs::is_character_file(device));
}

TEST(OutputFile, ADescriptorOfThisProcessIsAppendedTo) {
  const TempFolder folder;
  const auto path = folder.write("log", "before ");
  const int descriptor = open(path.c_str(), O_WRONLY | O_APPEND);
  ASSERT_GE(descriptor, 0);
  write_file("/dev/fd/" + std::to_string(descriptor), "content");
  EXPECT_EQ(write(descriptor, " after", 6), 6) << "it stays open";
  close(descriptor);
  EXPECT_EQ(read_file(path), "before content after");
  EXPECT_TRUE(is_standard_output(test::private_standard_output(folder)));
  EXPECT_TRUE(is_standard_output("/dev/stdout"));
  EXPECT_FALSE(is_standard_output(path));
}

TEST(OutputFile, TemporaryFilesAreUniqueAndLeaveNothing) {
  const TempFolder folder;
  {
    OutputFile a(folder.path() / "out.txt"), b(folder.path() / "out.txt");
    EXPECT_NE(a.temporary(), b.temporary());
    EXPECT_THAT(a.temporary().filename().string(), HasSubstr(std::to_string(getpid())));
    clear_abandoned_files(folder.path());
    EXPECT_TRUE(fs::exists(a.temporary())) << "in use";
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(OutputFile, LongNamesNeedNoLongerTemporaryName) {
  const TempFolder folder;
  const auto path = folder.path() / std::string(255, 'n');
  write_file(path, "new");
  EXPECT_EQ(read_file(path), "new");
}

TEST(FolderLock, OneAtATime) {
  const TempFolder folder;
  {
    const FolderLock lock(folder.path());
    EXPECT_THAT(input_error([&] { const FolderLock second(folder.path()); }),
                AllOf(HasSubstr(folder.path().string()), HasSubstr("another run"), HasSubstr("-o")));
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
  EXPECT_NO_THROW(const FolderLock again(folder.path()));
}

TEST(FolderLock, ClearsWhatKilledProcessesLeft) {
  const TempFolder folder;
  folder.write("kinloop-4242-0.tmp", "half");
  folder.write("kinloop-notes.txt", "of the user");
  folder.write("other.tmp", "of the user");
  const FolderLock lock(folder.path());
  EXPECT_FALSE(fs::exists(folder.path() / "kinloop-4242-0.tmp"));
  EXPECT_TRUE(fs::exists(folder.path() / "kinloop-notes.txt"));
  EXPECT_TRUE(fs::exists(folder.path() / "other.tmp"));
}

}  // namespace
}  // namespace kinloop
