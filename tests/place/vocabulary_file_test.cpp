#include "kinloop/place/vocabulary/vocabulary_file.hpp"

#include <cstring>

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/support/vocabulary_checksum.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

// The format as described in docs/method.md.
constexpr size_t kHeaderBytes = 48, kChecksumOffset = 40;

using test::with_vocabulary_checksum;

const Vocabulary& vocabulary() {
  static const Vocabulary kVocabulary = [] {
    TrainOptions options;
    options.branching = 3;
    options.depth = 3;
    return train_vocabulary(test::clustered_images(5, 40, 30, 1), options);
  }();
  return kVocabulary;
}

const std::string& bytes() {
  static const std::string kBytes = serialize_vocabulary(vocabulary());
  return kBytes;
}

std::string error_of(const std::string& content) {
  return input_error([&] { parse_vocabulary(content, "some.kinvoc", nullptr); });
}

TEST(VocabularyFile, SavedAndLoadedIsTheSame) {
  const test::TempFolder folder;
  const auto path = folder.path() / "a.kinvoc";
  write_vocabulary(path, vocabulary());
  const Vocabulary loaded = read_vocabulary(path);  // which keeps the file mapped
  const VocabularyView &a = vocabulary().tree(), &b = loaded.tree();
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.branching, b.branching);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.images, b.images);
  EXPECT_THAT(a.child_counts, testing::ElementsAreArray(b.child_counts));
  EXPECT_THAT(a.centres, testing::ElementsAreArray(b.centres));
  EXPECT_THAT(a.idf, testing::ElementsAreArray(b.idf));
  EXPECT_THAT(a.use_counts, testing::ElementsAreArray(b.use_counts));
  EXPECT_EQ(serialize_vocabulary(loaded), read_file(path));
  const cv::Mat descriptors = test::to_mat(test::clustered_descriptors(100, 100, 0.1, 9));
  EXPECT_EQ(loaded.quantize(descriptors).words, vocabulary().quantize(descriptors).words);
}

TEST(VocabularyFile, HasTheDocumentedChecksum) {
  EXPECT_EQ(with_vocabulary_checksum(bytes()), bytes());
}

TEST(VocabularyFile, CutShortAnywhereIsAnError) {
  for (size_t size = 0; size < bytes().size(); ++size) {
    ASSERT_THAT(error_of(bytes().substr(0, size)), HasSubstr("some.kinvoc: ")) << "cut to " << size;
  }
  EXPECT_THAT(error_of(bytes().substr(0, 1000)),
              AllOf(HasSubstr("1000 bytes"), HasSubstr("kinloop vocab train")));
  EXPECT_THAT(error_of(bytes() + "x"), HasSubstr("appended"));
}

TEST(VocabularyFile, AnyFlippedBitIsAnError) {
  ASSERT_GT(bytes().size(), kHeaderBytes);
  for (size_t at = 0; at < bytes().size(); ++at) {
    for (const unsigned bit : {0U, 7U}) {
      std::string altered = bytes();
      altered[at] = static_cast<char>(static_cast<unsigned char>(altered[at]) ^ (1U << bit));
      ASSERT_THAT(error_of(altered), HasSubstr("some.kinvoc: ")) << "byte " << at;
    }
  }
}

TEST(VocabularyFile, TwoFlippedTopBitsDoNotCancel) {
  std::string altered = bytes();
  for (const size_t at : {kHeaderBytes + 7, kHeaderBytes + 15})
    altered[at] = static_cast<char>(altered[at] ^ 0x80);
  EXPECT_THAT(error_of(altered), HasSubstr("damaged"));
}

TEST(VocabularyFile, OtherKindsAndVersionsAreNamed) {
  EXPECT_THAT(error_of("# not a vocabulary, but long enough to hold the header of one"),
              HasSubstr("not a kinloop vocabulary"));
  std::string other = bytes();
  other[8] = 1;
  EXPECT_THAT(error_of(with_vocabulary_checksum(other)), HasSubstr("format 1, this program reads format 2"));
  other = bytes();
  other[12] = 77;
  EXPECT_THAT(error_of(with_vocabulary_checksum(other)), HasSubstr("unknown descriptor kind 77"));
  other = bytes();
  other[12] = static_cast<char>(DescriptorKind::kSift);
  EXPECT_THAT(error_of(with_vocabulary_checksum(other)), HasSubstr("descriptors of 32 bytes, expected 128"));
}

TEST(VocabularyFile, NonsenseWithARightChecksumIsAnError) {
  // Any byte of the tree's shape (the child counts stand at the end), of the weights and of the counts in the
  // header may be altered deliberately: the result is an error or a valid tree, never a crash.
  size_t errors = 0;
  for (size_t at = 16; at < bytes().size(); at += at < kHeaderBytes ? 1 : 3) {
    if (at >= kChecksumOffset && at < kHeaderBytes) continue;
    for (const int value : {0, 1, 4, 255}) {
      std::string altered = bytes();
      altered[at] = static_cast<char>(value);
      try {
        const std::string right = with_vocabulary_checksum(altered);
        const Vocabulary sound = parse_vocabulary(right, "some.kinvoc", nullptr);
        (void)sound.quantize(cv::Mat(1, kOrbBytes, CV_8UC1, cv::Scalar(0x33)));
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("some.kinvoc: "));
        ++errors;
      }
    }
  }
  EXPECT_GT(errors, 50U);
}

TEST(VocabularyFile, AHeaderThatClaimsAHugeTreeIsAnErrorAtOnce) {
  std::string huge = bytes().substr(0, kHeaderBytes);
  for (size_t at = 28; at < 36; ++at) huge[at] = '\xff';
  EXPECT_THAT(error_of(with_vocabulary_checksum(huge)), HasSubstr("truncated"));
}

TEST(VocabularyFile, FilesThatCannotBeUsedAreNamed) {
  const test::TempFolder folder;
  EXPECT_THAT(input_error([&] { read_vocabulary(folder.path() / "none.kinvoc"); }), HasSubstr("none.kinvoc"));
  EXPECT_THAT(input_error([&] { read_vocabulary(folder.path()); }), HasSubstr(folder.path().string()));
  EXPECT_THAT(input_error([&] { read_vocabulary(folder.write("empty.kinvoc", "")); }),
              HasSubstr("empty.kinvoc"));
  EXPECT_THAT(
      input_error([&] { write_vocabulary(folder.path() / "no" / "such" / "a.kinvoc", vocabulary()); }),
      HasSubstr("a.kinvoc"));
}

TEST(VocabularyFile, IsUsableWhateverHappensToTheFile) {
  const test::TempFolder folder;
  const auto path = folder.write("words.kinvoc", bytes());
  const Vocabulary read = read_vocabulary(path);
  std::filesystem::resize_file(path, 0);
  EXPECT_EQ(serialize_vocabulary(read), bytes());
}

}  // namespace
}  // namespace kinloop
