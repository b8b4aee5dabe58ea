#include <cstring>

#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tests/support/vocabulary_checksum.hpp"

namespace kinloop::fuzz {
namespace {

void read_file_of_bytes(std::string_view bytes) {
  with_file("words.kinvoc", bytes, [](const auto& path) {
    accept([&] {
      const Vocabulary vocabulary = read_vocabulary(path);
      const auto row_bytes = static_cast<int>(vocabulary.descriptors().bytes);
      static_cast<void>(vocabulary.quantize(cv::Mat(2, row_bytes, CV_8UC1, cv::Scalar(85)), 2));
      require(serialize_vocabulary(vocabulary).size() == std::filesystem::file_size(path),
              "a vocabulary changes when it is written");
    });
  });
}

}  // namespace

/// Also with the checksum corrected, without which nearly all changes would end at the checksum.
void read_vocabulary_bytes(std::string_view bytes) {
  read_file_of_bytes(bytes);
  read_file_of_bytes(test::with_vocabulary_checksum(std::string(bytes)));
}

}  // namespace kinloop::fuzz
