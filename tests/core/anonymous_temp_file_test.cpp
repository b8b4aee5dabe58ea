#include "kinloop/core/files/anonymous_temp_file.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/expect_error.hpp"
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

TEST(AnonymousTempFile, AMissingFolderIsNamed) {
  const test::TempFolder folder;
  const auto nowhere = folder.path() / "nowhere";
  const test::EnvironmentVariable variable("TMPDIR", nowhere.string());
  EXPECT_THAT(test::input_error([] { MappedTempFile().add(std::array<uint8_t, 3>{}); }),
              testing::AllOf(testing::HasSubstr(nowhere.string()), testing::HasSubstr("TMPDIR"),
                             testing::Not(testing::HasSubstr("space"))));
}

/// `count` bytes that differ from those of another seed.
std::vector<uint8_t> bytes_of(uint8_t seed, size_t count) {
  std::vector<uint8_t> bytes(count);
  for (size_t i = 0; i < count; ++i) bytes[i] = static_cast<uint8_t>(seed + i * 7);
  return bytes;
}

TEST(MappedTempFile, ReadsWhatWasStored) {
  constexpr size_t kLarge = size_t{20} << 20;  // more than a segment
  MappedTempFile file;
  std::vector<std::pair<std::vector<uint8_t>, std::shared_ptr<const uint8_t>>> stored;
  for (const size_t count :
       {size_t{1}, size_t{1000}, kLarge, size_t{4096}, kLarge / 2, kLarge / 2, size_t{3}}) {
    auto bytes = bytes_of(static_cast<uint8_t>(stored.size()), count);
    auto place = file.add(bytes);
    stored.emplace_back(std::move(bytes), std::move(place));
  }
  EXPECT_EQ(file.size_bytes(), 2 * kLarge + 1 + 1000 + 4096 + 3);
  for (int reading = 0; reading < 2; ++reading) {
    for (const auto& [bytes, place] : stored) {
      EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), place.get()));
      EXPECT_EQ(reinterpret_cast<uintptr_t>(place.get()) % 64, 0U);
    }
    file.drop_pages();
  }
}

TEST(MappedTempFile, BytesOutliveTheFile) {
  std::shared_ptr<const uint8_t> place;
  {
    MappedTempFile file;
    place = file.add(bytes_of(1, 100));
  }
  EXPECT_EQ(place.get()[99], bytes_of(1, 100)[99]);
}

TEST(MappedTempFile, WithoutAFolderThereIsNone) {
  const test::TempFolder folder;
  const test::EnvironmentVariable elsewhere("TMPDIR", (folder.path() / "nowhere").string());
  MappedTempFile file;
  EXPECT_THROW(file.add(bytes_of(1, 100)), InputError);
  EXPECT_EQ(file.size_bytes(), 0U);
}

}  // namespace
}  // namespace kinloop
