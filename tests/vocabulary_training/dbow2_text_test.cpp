#include "tools/vocabulary_training/dbow2_text.hpp"

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

/// A line of the file, with all bytes of the descriptor equal.
std::string node(int parent, int is_word, int byte, double weight) {
  std::string line = std::to_string(parent) + " " + std::to_string(is_word) + " ";
  for (int i = 0; i < kOrbBytes; ++i) line += std::to_string(byte) + " ";
  return line + std::to_string(weight) + "\n";
}

TEST(Dbow2Text, NodesMayComeInAnyOrderBelowTheirParents) {
  // Depth first, as DBoW2 writes them: 1 (2, 3) and the word 4.
  const test::TempFolder folder;
  const auto path = folder.write("voc.txt", "2 2 0 0\n" + node(0, 0, 0, 0) + node(1, 1, 1, 1.5) +
                                                node(1, 1, 7, 2.5) + node(0, 1, 255, 3.5));
  const Vocabulary read = read_dbow2(path);
  EXPECT_THAT(read.tree().child_counts, ElementsAre(2, 2, 0, 0, 0));
  EXPECT_THAT(read.tree().idf, ElementsAre(3.5F, 1.5F, 2.5F));  // words breadth first
  EXPECT_EQ(read.centre_of({2})[0], 7);
  const cv::Mat descriptor(1, kOrbBytes, CV_8UC1, cv::Scalar(6));  // nearer to 7 than to 1
  EXPECT_THAT(read.quantize(descriptor).words, ElementsAre(WordId{2}));
}

TEST(Dbow2Text, ExportedAndImportedIsTheSame) {
  TrainOptions options;
  options.branching = 4;
  options.depth = 3;
  const Vocabulary trained = train_vocabulary(test::clustered_images(8, 50, 60, 1), options);
  const test::TempFolder folder;
  write_dbow2(folder.path() / "voc.txt", trained);
  const Vocabulary read = read_dbow2(folder.path() / "voc.txt");
  EXPECT_THAT(read.tree().child_counts, ElementsAreArray(trained.tree().child_counts));
  EXPECT_THAT(read.tree().centres.subspan(kOrbBytes),
              ElementsAreArray(trained.tree().centres.subspan(kOrbBytes)));
  EXPECT_THAT(read.tree().idf, ElementsAreArray(trained.tree().idf));
  const cv::Mat descriptors = test::to_mat(test::clustered_descriptors(100, 100, 0.1, 9));
  EXPECT_EQ(read.bow_of(read.quantize(descriptors).words),
            trained.bow_of(trained.quantize(descriptors).words));
}

TEST(Dbow2Text, ErrorsNameFileAndLine) {
  const test::TempFolder folder;
  const auto error_of = [&](const std::string& content) {
    const auto path = folder.write("voc.txt", content);
    return test::input_error([&] { read_dbow2(path); });
  };
  const std::string word = node(0, 1, 9, 1);
  EXPECT_THAT(error_of(""), HasSubstr("voc.txt"));
  EXPECT_THAT(error_of("10 6 1 0\n"), HasSubstr("voc.txt:1: expected L1 scoring"));
  EXPECT_THAT(error_of("10 6 0 3\n"), HasSubstr("TF-IDF"));
  EXPECT_THAT(error_of("2 2 0 0\n" + word + node(7, 1, 9, 1)),
              HasSubstr("voc.txt:3: expected the number of a"));
  EXPECT_THAT(error_of("2 2 0 0\n" + word + word.substr(0, 40)), HasSubstr("voc.txt:3: expected a byte"));
  EXPECT_THAT(error_of("2 2 0 0\n" + word + node(0, 1, 300, 1)), HasSubstr("from 0 to 255"));
  EXPECT_THAT(error_of("2 2 0 0\n" + word + node(0, 1, 3, -1)), HasSubstr("a weight"));
  EXPECT_THAT(error_of("2 2 0 0\n" + word + node(1, 1, 3, 1)), HasSubstr("a word with children"));
  EXPECT_THAT(error_of("2 2 0 0\n" + word + node(0, 0, 3, 1)), HasSubstr("has no children"));
  EXPECT_THAT(error_of("2 2 0 0\n"), HasSubstr("no word"));
  EXPECT_THAT(error_of("2 1 0 0\n" + word + word + word), HasSubstr("shape of the tree"));
}

}  // namespace
}  // namespace kinloop
