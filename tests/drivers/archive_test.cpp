// Archives as input: they are read like the folder that was packed, and crafted ones do no harm.

#include <gmock/gmock.h>

#include "drivers/archives/unpack_archive.hpp"
#include "drivers/archives/unpacked_archive.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/drivers/archive_writer.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

#ifdef KINLOOP_WITH_ARCHIVES
#include <clocale>
#include <memory>

#include <archive.h>
#include <archive_entry.h>
#endif

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::input_error;
using test::tar_member;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(ArchiveName, IsToldByItsEnding) {
  for (const char* name :
       {"a.zip", "A.ZIP", "b.r3d", "c.tar", "c.tar.gz", "c.tgz", "c.tar.xz", "c.tar.zst", "d.7z"})
    EXPECT_TRUE(is_archive_name(name)) << name;
  for (const char* name : {"zip", ".zip", "a.zip.txt", "b.gz", "folder"})
    EXPECT_FALSE(is_archive_name(name)) << name;
}

#ifdef KINLOOP_WITH_ARCHIVES

/// Packs all files of a folder, below `top` in the archive. Its writers need a locale with UTF-8.
fs::path pack(const fs::path& folder, const fs::path& file, const fs::path& top = {}) {
  const std::unique_ptr<archive, decltype(&archive_write_free)> writer(archive_write_new(),
                                                                       archive_write_free);
  std::setlocale(LC_CTYPE, "C.UTF-8");
  archive_write_set_format_filter_by_ext(writer.get(), file.c_str());
  archive_write_open_filename(writer.get(), file.c_str());
  for (const auto& packed : fs::recursive_directory_iterator(folder)) {
    if (!packed.is_regular_file()) continue;
    const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(),
                                                                              archive_entry_free);
    const std::string content = read_file(packed.path());
    archive_entry_set_pathname_utf8(entry.get(), (top / fs::relative(packed.path(), folder)).c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_write_header(writer.get(), entry.get());
    archive_write_data(writer.get(), content.data(), content.size());
  }
  std::setlocale(LC_CTYPE, "C");
  return file;
}

class ArchiveInput : public testing::Test {
 protected:
  /// Returns whether nothing is left of what was unpacked.
  [[nodiscard]] bool is_cleaned_up() const { return fs::is_empty(temporary_.path()); }

  const test::SequenceFolder sequence_{3};
  const test::TempFolder folder_, temporary_;
  const test::EnvironmentVariable tmpdir_{"TMPDIR", temporary_.path().string()};
};

TEST_F(ArchiveInput, IsReadLikeTheFolder) {
  for (const char* name : {"r.zip", "r.r3d", "r.tar", "r.tgz", "r.tar.gz", "r.tar.xz", "r.tar.bz2", "r.7z"}) {
    for (const char* top : {"", "räume/küche"}) {
      const std::string packed = (folder_.path() / name).string();
      const std::string by_ending =
          std::string(name) == "r.r3d" ? (folder_.path() / "x.zip").string() : packed;
      fs::rename(pack(sequence_.path(), by_ending, top), packed);
      {
        const auto there = open_sequence(sequence_.path().string()), source = open_sequence(packed);
        EXPECT_EQ(source->info().name, packed);
        EXPECT_EQ(source->info().frames, 3U);
        while (const auto frame = there->next()) {
          const auto same = source->next();
          ASSERT_TRUE(same) << name << top;
          EXPECT_EQ(same->stamp_ns, frame->stamp_ns);
          EXPECT_EQ(cv::norm(same->color.bgr(), frame->color.bgr(), cv::NORM_INF), 0);
          EXPECT_EQ(cv::norm(same->depth_m, frame->depth_m, cv::NORM_INF), 0);
        }
        EXPECT_FALSE(is_cleaned_up());
      }
      EXPECT_TRUE(is_cleaned_up()) << name << top;
    }
  }
}

TEST_F(ArchiveInput, OfSeveralSequencesOneIsChosen) {
  fs::create_directories(folder_.path() / "all/day");
  fs::copy(sequence_.path(), folder_.path() / "all/day/one", fs::copy_options::recursive);
  fs::copy(sequence_.path(), folder_.path() / "all/two", fs::copy_options::recursive);
  const std::string packed = pack(folder_.path() / "all", folder_.path() / "rooms.zip").string();
  EXPECT_THAT(
      input_error([&] { open_sequence(packed); }),
      AllOf(
          StartsWith(packed + ": contains 2 sequences; choose one: --sequence day/one, or give its folder, "),
          HasSubstr(packed + "/day/one"), Not(HasSubstr(temporary_.path().string()))));
  EXPECT_EQ(open_sequence(packed, {}, {}, "two")->info().name, packed + "/two");
  EXPECT_EQ(open_sequence(packed + "/day/one")->info().name, packed + "/day/one");
  EXPECT_THAT(input_error([&] { open_sequence(packed, {}, {}, "three"); }), HasSubstr("but no 'three'"));
  EXPECT_TRUE(is_cleaned_up());
}

TEST_F(ArchiveInput, ErrorsNameTheMember) {
  write_file(sequence_.path() / "rgb/0.png", "no image");
  const std::string packed = pack(sequence_.path(), folder_.path() / "r.zip").string();
  const auto source = open_sequence(packed);
  while (source->next()) {
  }
  ASSERT_EQ(source->skipped().size(), 1U);
  EXPECT_THAT(source->skipped().front().reason, StartsWith(packed + "/rgb/0.png: "));
  fs::remove(sequence_.path() / "camera.yaml");
  fs::remove(packed);
  pack(sequence_.path(), packed);
  EXPECT_THAT(input_error([&] { open_sequence(packed); }), StartsWith(packed + ": no camera: "));
}

TEST_F(ArchiveInput, WhatMacOsAddsIsLeftOut) {
  const std::string file =
      folder_.write("r.tar", tar_member("__MACOSX/a/rgb.txt", "x") + tar_member("a/._1.png", "x") +
                                 tar_member("a/1.png", "y") + test::tar_end());
  const auto files = unpack_archive(file, folder_.path() / "out", {1 << 20, "too much"});
  EXPECT_EQ(files.count, 1U);
  EXPECT_EQ(read_file(folder_.path() / "out/a/1.png"), "y");
  EXPECT_FALSE(fs::exists(folder_.path() / "out/__MACOSX"));
}

TEST_F(ArchiveInput, NothingLandsElsewhere) {
  const test::TempFolder target;
  const struct {
    std::string members;
    const char* said;
  } crafted[] = {
      {tar_member("../evil", "x"), ": ../evil: leads out of the folder"},
      {tar_member("a/../../evil", "x"), ": a/../../evil: leads out of the folder"},
      {tar_member("link", "", '2', "/etc/passwd"), ": link: neither a file nor a folder"},
      {tar_member("link", "", '2', "..") + tar_member("link/evil", "x"),
       ": link: neither a file nor a folder"},
      {tar_member("link", "", '1', "/etc/passwd"), ": link: neither a file nor a folder"},
      {tar_member("device", "", '3'), ": device: neither a file nor a folder"},
      {tar_member("\x1b[2J/../evil", "x"), "evil: leads out of the folder"},
      {tar_member("a", "x") + tar_member("a/b", "x"), ": a/b: cannot be written"},
  };
  for (const auto& [members, said] : crafted) {
    const auto file = folder_.write("r.tar", members + test::tar_end());
    const std::string error = input_error([&] {
      unpack_archive(file, target.path() / "in/it", {1 << 20, "too much"});
    });
    EXPECT_THAT(error, AllOf(StartsWith(file.string()), HasSubstr(said), Not(HasSubstr("\x1b"))));
    EXPECT_FALSE(fs::exists(target.path() / "evil") || fs::exists(target.path() / "in/evil"));
    fs::remove_all(target.path() / "in");
  }
  const auto file = folder_.write("r.tar", tar_member("/abs/olute", "x") + test::tar_end());
  unpack_archive(file, target.path() / "in", {1 << 20, "too much"});
  EXPECT_EQ(read_file(target.path() / "in/abs/olute"), "x");
}

TEST_F(ArchiveInput, NoMoreIsWrittenThanTheLimit) {
  const test::TempFolder target;
  const UnpackLimit limit{64 << 10, "too much"};
  const auto refused = [&](const fs::path& file) {
    fs::remove_all(target.path() / "in");
    return input_error([&] { unpack_archive(file, target.path() / "in", limit); });
  };
  EXPECT_THAT(
      refused(folder_.write("stated.tar", tar_member("big", "x", '0', {}, 1LL << 32) + test::tar_end())),
      HasSubstr("stated.tar: big: too much"));
  EXPECT_EQ(fs::exists(target.path() / "in/big"), false);
  const test::TempFolder zeros;
  zeros.write("zeros", std::string(1 << 20, '\0'));
  for (const char* name : {"bomb.zip", "bomb.tar.xz"})
    EXPECT_THAT(refused(pack(zeros.path(), folder_.path() / name)), HasSubstr(": zeros: too much")) << name;
  std::string many;
  for (int i = 0; i < 100; ++i) many += tar_member(std::to_string(i), "");  // each takes a block of the disk
  EXPECT_THAT(refused(folder_.write("many.tar", many + test::tar_end())), HasSubstr("too much"));
}

TEST_F(ArchiveInput, ATruncatedOneIsNamed) {
  for (const char* name : {"r.zip", "r.tar", "r.tar.gz", "r.7z"}) {
    const std::string whole = read_file(pack(sequence_.path(), folder_.path() / name));
    for (const size_t percent : {0U, 30U, 60U}) {
      const auto file = folder_.write(name, std::string_view(whole).substr(0, whole.size() * percent / 100));
      EXPECT_THAT(input_error([&] { open_sequence(file.string()); }), StartsWith(file.string())) << percent;
    }
    EXPECT_TRUE(is_cleaned_up());
  }
  const auto text = folder_.write("t.zip", "no archive");
  EXPECT_THAT(input_error([&] { open_sequence(text.string()); }),
              HasSubstr("t.zip: no archive that can be read"));
}

#endif

}  // namespace
}  // namespace kinloop
