#include "kinloop/core/files/text_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

size_t files_in(const fs::path& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(ReadFile, GivesTheBytesAsTheyAre) {
  const TempFolder folder;
  const std::string bytes("a\0\r\n\xff b", 7);
  EXPECT_EQ(read_file(folder.write("a", bytes)), bytes);
  EXPECT_EQ(read_file(folder.write("empty", "")), "");
}

TEST(ReadFile, WhatCannotBeReadIsNamed) {
  const TempFolder folder;
  EXPECT_THAT(input_error([&] { read_file(folder.path() / "none"); }),
              AllOf(HasSubstr("none"), HasSubstr("no such file")));
  EXPECT_THAT(input_error([&] { read_file(folder.path()); }), HasSubstr("not a regular file"));
  EXPECT_THAT(input_error([&] { read_file("/dev/zero"); }), HasSubstr("not a regular file"));
}

TEST(RequireFolder, TellsMissingFromWrong) {
  const TempFolder folder;
  EXPECT_NO_THROW(require_folder(folder.path()));
  EXPECT_THAT(input_error([&] { require_folder(folder.path() / "none"); }), HasSubstr("no such folder"));
  EXPECT_THAT(input_error([&] { require_folder(folder.write("file", "")); }), HasSubstr("not a folder"));
}

TEST(ReadTable, SplitsAtWhiteSpaceAndCountsEveryLine) {
  const TempFolder folder;
  const auto lines = read_table(folder.write("t", "# head\n\n 1.5\trgb/a.png  \r\n#\nlast"));
  ASSERT_THAT(lines, SizeIs(2));
  EXPECT_EQ(lines[0].number, 3U);
  EXPECT_THAT(lines[0].fields, ElementsAre("1.5", "rgb/a.png"));
  EXPECT_EQ(lines[1].number, 5U);
  EXPECT_THAT(lines[1].fields, ElementsAre("last"));
}

TEST(ReadTable, SkipsAByteOrderMark) {
  const TempFolder folder;
  const auto lines = read_table(folder.write("t", "\xEF\xBB\xBF# head\n1.5 a\n"));
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_THAT(lines[0].fields, ElementsAre("1.5", "a"));
  EXPECT_THAT(read_table(folder.write("t",
                                      "\xEF\xBB\xBF"
                                      "1.5 a\n"))[0]
                  .fields,
              ElementsAre("1.5", "a"));
}

TEST(ReadTable, TakesLinesOfAnyLengthUpToTheLimit) {
  const TempFolder folder;
  for (const size_t length : {1U, 4094U, 4095U, 4096U, 8190U, 8191U, 100'000U}) {
    const std::string word(length, 'x');
    const auto lines = read_table(folder.write("t", word + "\n\n" + word));
    ASSERT_THAT(lines, SizeIs(2)) << length;
    EXPECT_THAT(lines[0].fields, ElementsAre(word));
    EXPECT_THAT(lines[1].fields, ElementsAre(word));
    EXPECT_EQ(lines[1].number, 3U);
  }
  const auto endless = folder.write("t", "a b\n" + std::string((1 << 20) + 1, 'x'));
  EXPECT_THAT(input_error([&] { read_table(endless); }), HasSubstr("t:2: a line of more than 1 MiB"));
}

TEST(ReadTable, RefusesLargeFilesBeforeTheyAreRead) {
  const TempFolder folder;
  const auto list = folder.write("list.txt", "");
  fs::resize_file(list, kMostListBytes + 1);  // without a block on the disk
  EXPECT_THAT(
      input_error([&] { read_table(list); }),
      AllOf(HasSubstr("list.txt: 33554433 bytes"), HasSubstr("at most 33554432"), HasSubstr("split")));
}

TEST(VisitTable, NeedsMemoryForOneLine) {
  constexpr int kLines = 1'000'000;
  const TempFolder folder;
  std::string text;
  for (int i = 0; i < kLines; ++i) text += "1 2 3 4 5 6 7 8\n";
  const auto file = folder.write("poses.txt", text);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  int lines = 0;
  visit_table(file, [&](const TextLine& line) { lines += line.fields.size() == 8 ? 1 : 0; });
  getrusage(RUSAGE_SELF, &after);
  EXPECT_EQ(lines, kLines);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 16 << 10) << "KiB";
}

TEST(RequireRegularFile, NamesWhatThereIsInstead) {
  const TempFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(input_error([&] { require_regular_file(pipe); }),
              HasSubstr("pipe: a pipe, not a regular file"));
  EXPECT_THAT(input_error([&] { read_table(pipe); }), HasSubstr("a pipe, not a regular file"));
  EXPECT_THAT(input_error([&] { require_regular_file(folder.path()); }), HasSubstr("a folder, not"));
  EXPECT_THAT(input_error([&] { require_regular_file("/dev/zero"); }), HasSubstr("a device, not"));
}

TEST(ParseDouble, TakesFiniteNumbersOnly) {
  EXPECT_EQ(parse_double("-1.5e-3", "f", 1), -0.0015);
  EXPECT_EQ(parse_double("+2", "f", 1), 2);
  for (const char* text : {"", "+", "nan", "-nan", "inf", "1e999", "1.5x", "1,5", "0x10"}) {
    EXPECT_THAT(input_error([&] { parse_double(text, "some/file.txt", 17); }),
                AllOf(HasSubstr("some/file.txt:17:"), HasSubstr("not a finite number")))
        << text;
  }
}

TEST(AtomicFile, AppearsUnderItsNameOnlyWhenComplete) {
  const TempFolder folder;
  const auto path = folder.path() / "out.txt";
  {
    AtomicFile file(path);
    file.stream() << "new";
    EXPECT_FALSE(fs::exists(path));
    file.commit();
    EXPECT_EQ(read_file(path), "new");
  }
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, WithoutACommitTheOlderFileStays) {
  const TempFolder folder;
  const auto path = folder.write("out.txt", "old");
  {
    AtomicFile file(path);
    file.stream() << "half of the n";
  }
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, WriteFileReplaces) {
  const TempFolder folder;
  const auto path = folder.write("out.txt", "something longer");
  write_file(path, "short");
  EXPECT_EQ(read_file(path), "short");
}

TEST(MakeFolder, MakesWhatIsMissingOrSaysWhyNot) {
  const TempFolder folder;
  const auto inner = folder.path() / "a/b";
  make_folder(inner);
  make_folder(inner);  // already exists
  EXPECT_TRUE(fs::is_directory(inner));
  folder.write("file", "x");
  EXPECT_THAT(input_error([&] { make_folder(folder.path() / "file/inner"); }),
              AllOf(HasSubstr("file/inner"), HasSubstr("choose another")));
}

TEST(AtomicFile, FolderThatIsNotThereOrNotWritable) {
  const TempFolder folder;
  EXPECT_THAT(input_error([&] { AtomicFile file(folder.path() / "none/out.txt"); }),
              AllOf(HasSubstr("none/out.txt"), HasSubstr("writable")));
  // Even root cannot create files in /proc.
  EXPECT_THAT(input_error([] { AtomicFile file("/proc/out.txt"); }), HasSubstr("/proc/out.txt"));
}

TEST(AtomicFile, FullDiskIsNoticedAndLeavesTheOlderFile) {
  const TempFolder folder;
  const auto path = folder.write("out.txt", "old");
  EXPECT_THAT(
      test::on_a_full_disk([&] { return input_error([&] { write_file(path, std::string(10'000, 'x')); }); }),
      AllOf(HasSubstr("out.txt"), HasSubstr("disk full")));
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, FolderOfThatNameIsNotReplaced) {
  const TempFolder folder;
  fs::create_directory(folder.path() / "out");
  folder.write("out/precious", "x");
  EXPECT_THAT(input_error([&] { write_file(folder.path() / "out", "new"); }), HasSubstr("is a folder"));
  EXPECT_TRUE(fs::exists(folder.path() / "out/precious"));
}

}  // namespace
}  // namespace kinloop
