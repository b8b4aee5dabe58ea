#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tools/vocabulary_training/dbow2_text.hpp"

namespace kinloop::fuzz {

void read_dbow2_bytes(std::string_view bytes) {
  with_file("vocabulary.txt", bytes, [](const auto& path) {
    accept([&] {
      const Vocabulary vocabulary = read_dbow2(path);
      static_cast<void>(vocabulary.quantize(cv::Mat(2, 32, CV_8UC1, cv::Scalar(85)), 2));
      write_dbow2(path, vocabulary);
      require(read_dbow2(path).word_count() == vocabulary.word_count(),
              "a vocabulary changes when it is written");
    });
  });
}

}  // namespace kinloop::fuzz
